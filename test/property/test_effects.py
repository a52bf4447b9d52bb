"""Laws over every registered effect, built in or installed."""

import ast
import inspect
import math
import sys
import textwrap

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_sim.compose import kernel_source
from lta_sim.effects import EFFECTS, initial_memory
from lta_sim.effects.basis import basis
from lta_sim.effects.protocol import ActuatorEffect, InertiaEffect, Motion, WrenchEffect
from lta_sim.kernel import advance
from lta_sim.model import Model
from lta_sim.state import ACTUATORS, pack, RIGID
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

UNITS = {'1', 'm', 's', 'kg', 'kg m^2', 'N', 'N/m', 'N s/m', 'N m s', 'N s^2/m^2', 'N m s^2'}


def kind(*kinds):
    return [effect for effect in EFFECTS.values() if isinstance(effect, kinds)]


def of(effect):
    return effect.name


def functions(effect):
    match effect:
        case WrenchEffect():
            return [effect.wrench]
        case ActuatorEffect():
            return [effect.output, effect.rate]
        case InertiaEffect():
            return [effect.diagonal]


def nulls(effect):
    return tuple(parameter.null for parameter in effect.parameters)


def reach(parameter):
    """Return values of a parameter that a small vehicle may have."""
    low, high = max(parameter.low, -10.0), min(parameter.high, 10.0)
    return st.floats(low, high, allow_subnormal=False)


def parameters(effect):
    return st.tuples(*(reach(parameter) for parameter in effect.parameters))


laws = settings(deadline=None, max_examples=50)
number = st.floats(-5.0, 5.0, allow_subnormal=False)
vectors = st.tuples(number, number, number)
duties = st.tuples(*[st.floats(-1.0, 1.0, allow_subnormal=False)] * ACTUATORS)


@st.composite
def motions(draw):
    turn = Rotation.from_euler('ZYX', draw(vectors))
    rotation = tuple(turn.as_matrix().ravel().tolist())
    return Motion(draw(vectors), rotation, draw(vectors), draw(vectors), draw(vectors))


@pytest.mark.parametrize('effect', EFFECTS.values(), ids=of)
def test_parameters_are_declared_in_full(effect):
    names = [parameter.name for parameter in effect.parameters]
    assert len(set(names)) == len(names) > 0
    for parameter in effect.parameters:
        assert parameter.unit in UNITS
        assert math.isfinite(parameter.null)
        assert -math.inf < parameter.low < parameter.high < math.inf
        assert 0.0 < parameter.spread <= parameter.high - parameter.low
        assert len(parameter.source) > 10


@pytest.mark.parametrize('effect', EFFECTS.values(), ids=of)
def test_its_file_tells_what_it_is(effect):
    module = sys.modules[functions(effect)[0].__module__]
    assert EFFECTS[effect.name] is effect
    assert '=' in (module.__doc__ or ''), 'the equations stand at the top of the file'
    assert len(inspect.getsource(module).splitlines()) <= 300


@pytest.mark.parametrize('effect', EFFECTS.values(), ids=of)
def test_functions_unpack_the_parameters_in_their_order(effect):
    for function in functions(effect):
        tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        unpack = next(node for node in tree.body if isinstance(node, ast.Assign))
        assert isinstance(unpack.value, ast.Name)
        assert unpack.value.id == 'p'
        names = [item.id for item in unpack.targets[0].elts]
        assert names == [parameter.name for parameter in effect.parameters]


@pytest.mark.parametrize('effect', kind(WrenchEffect), ids=of)
@laws
@given(data=st.data())
def test_null_gives_no_wrench(effect, data):
    wrench = effect.wrench(nulls(effect), data.draw(motions()), data.draw(duties))
    assert wrench == (0.0,) * 6


@pytest.mark.parametrize('effect', kind(ActuatorEffect), ids=of)
@laws
@given(data=st.data())
def test_null_passes_the_duty_on(effect, data):
    memory = data.draw(st.tuples(*[number] * len(effect.memory)))
    for duty in data.draw(duties):
        assert effect.output(nulls(effect), memory, duty) == duty
        assert all(math.isfinite(rate) for rate in effect.rate(nulls(effect), memory, duty))


@pytest.mark.parametrize('effect', kind(InertiaEffect), ids=of)
@laws
@given(data=st.data())
def test_inertia_is_never_negative_and_null_is_none(effect, data):
    assert effect.diagonal(nulls(effect)) == (0.0,) * 6
    assert min(effect.diagonal(data.draw(parameters(effect)))) >= 0.0


@pytest.mark.parametrize('effect', kind(WrenchEffect), ids=of)
@laws
@given(data=st.data())
def test_linear_parameters_are_linear(effect, data):
    values, motion = data.draw(parameters(effect)), data.draw(motions())
    duty = data.draw(duties)
    named = {known.name: value for known, value in zip(effect.parameters, values, strict=True)}
    assert set(effect.linear_in) <= set(named)
    columns = basis(effect, named, motion, duty)
    linear = np.array([named[name] for name in effect.linear_in])
    wrench = effect.wrench(values, motion, duty)
    scale = abs(columns) @ abs(linear) + 1.0
    assert np.all(abs(columns @ linear - wrench) <= 1e-12 * scale)


@pytest.mark.parametrize('effect', kind(WrenchEffect), ids=of)
@laws
@given(data=st.data(), heading=st.floats(-3.0, 3.0))
def test_the_room_has_no_preferred_heading(effect, data, heading):
    values, motion = data.draw(parameters(effect)), data.draw(motions())
    duty = data.draw(duties)
    turn = Rotation.from_euler('z', heading)
    rotation = turn.as_matrix() @ np.reshape(motion.rotation, (3, 3))
    turned = motion._replace(
        position=tuple(turn.apply(motion.position).tolist()),
        rotation=tuple(rotation.ravel().tolist()),
    )
    one = np.array(effect.wrench(values, motion, duty))
    two = np.array(effect.wrench(values, turned, duty))
    np.testing.assert_allclose(two, one, atol=1e-9 * (1.0 + np.max(abs(one))))


DRAG = [effect for effect in kind(WrenchEffect) if effect.name.endswith('_drag')]


@pytest.mark.parametrize('effect', DRAG, ids=of)
@laws
@given(data=st.data())
def test_drag_dissipates(effect, data):
    motion = data.draw(motions())
    wrench = effect.wrench(data.draw(parameters(effect)), motion, data.draw(duties))
    assert np.dot(wrench, (*motion.airspeed, *motion.rates)) <= 0.0


@pytest.mark.parametrize('effect', kind(ActuatorEffect), ids=of)
@laws
@given(duty=st.floats(-1.0, 1.0), data=st.data())
def test_memory_settles(effect, duty, data):
    values = data.draw(parameters(effect))
    memory = tuple(initial for _, initial in effect.memory)
    step = 0.2 * min([value for value in values if value > 0.0], default=1.0)
    for _ in range(2000):
        rates = effect.rate(values, memory, duty)
        memory = tuple(m + step * rate for m, rate in zip(memory, rates, strict=True))
    settled = effect.output(values, memory, duty)
    assert math.isfinite(settled)
    assert effect.output(values, memory, duty) == pytest.approx(settled)


def as_python(effects):
    """Return the kernel of some effects as plain, slow Python."""
    source = kernel_source(effects).replace('from numba import njit', '')
    space = {'njit': lambda **_: lambda function: function}
    exec(source, space)
    return space['advance']


GIVEN = {
    'weight_and_buoyancy': {'buoyancy': 3.4, 'weight': 3.5, 'cg_x': 0.01, 'cg_z': -0.08},
    'added_mass': {'surge': 0.14, 'sway': 0.15, 'heave': 0.37, 'roll': 4e-3, 'pitch': 5e-3},
    'linear_drag': {'surge': 0.01, 'roll': 7e-4, 'pitch': 6e-4, 'yaw': 3e-4},
    'quadratic_drag': {'surge': 0.09, 'sway': 0.09, 'heave': 0.36, 'roll': 2e-3, 'yaw': 6e-4},
    'motor_lag': {'up': 0.07, 'down': 0.1},
    'rotor_thrust': {'a_1': 0.09, 'b_1': 0.07, 'b_3': 0.1, 'heave_1': 0.96, 'surge_3': 0.98},
    'floor_contact': {'stiffness': 100.0, 'relaxation': 0.05, 'friction': 0.5, 'z': -0.36},
}


def flight(effects, kernel, given):
    """Return the rigid part of a state a few steps on, with the memory that these effects have."""
    model = Model.build(
        given, mass=0.36, cg=(0.01, 0.0, -0.08), inertia=np.diag([0.02, 0.02, 0.03])
    )
    numbers, first = [], 0
    for name, effect in EFFECTS.items():
        last = first + len(effect.parameters)
        numbers += model.parameters[first:last].tolist() if name in effects else []
        first = last
    memory = [
        0.3 for effect in effects.values() if isinstance(effect, ActuatorEffect)
        for _ in range(ACTUATORS * len(effect.memory))
    ]  # fmt: skip
    start = pack((1.0, 2.0, 0.33), 0.3, (0.3, -0.2, -0.1), (0.4, 0.5, -0.6), memory).tolist()
    out = [0.0] * len(start)
    body, inverse = model.body.tolist(), model.inverse.tolist()
    kernel(start, numbers, body, inverse, [0.4, -0.2, 0.6, 0.1], [0.2, 0.1, 0.0], 2e-3, 10, out)
    return model, start, out


@pytest.mark.parametrize('absent', EFFECTS)
def test_null_changes_nothing_to_the_bit(absent):
    """A kernel without the effect and the compiled kernel with it at null are equal."""
    others = {name: effect for name, effect in EFFECTS.items() if name != absent}
    given = {name: values for name, values in GIVEN.items() if name != absent}
    model, _, without = flight(others, as_python(others), given)
    start = pack((1.0, 2.0, 0.33), 0.3, (0.3, -0.2, -0.1), (0.4, 0.5, -0.6), initial_memory())
    start[RIGID:] = 0.3
    at_null = advance(start, model, (0.4, -0.2, 0.6, 0.1), (0.2, 0.1, 0.0), 2e-3, 10)
    np.testing.assert_array_equal(at_null[:RIGID], without[:RIGID])


def test_the_compiled_kernel_equals_its_text_to_the_bit():
    model, start, python = flight(EFFECTS, as_python(EFFECTS), GIVEN)
    compiled = advance(np.array(start), model, (0.4, -0.2, 0.6, 0.1), (0.2, 0.1, 0.0), 2e-3, 10)
    np.testing.assert_array_equal(compiled, python)


def test_each_effect_of_that_flight_matters():
    model, start, everything = flight(EFFECTS, as_python(EFFECTS), GIVEN)
    del model, start
    for absent in GIVEN:
        given = {name: values for name, values in GIVEN.items() if name != absent}
        _, _, without = flight(EFFECTS, as_python(EFFECTS), given)
        assert np.max(abs(np.subtract(everything, without)[:RIGID])) > 1e-7
