"""Laws over every registered effect, built in or installed."""

import ast
import inspect
import math
import sys
import textwrap

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_config.quantity import UNITS
from lta_sim import row
from lta_sim.compose import kernel_source, layout_of
from lta_sim.effects import EFFECTS, initial_memory
from lta_sim.effects.basis import basis
from lta_sim.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    CHANNELS,
    InertiaEffect,
    MeasurementEffect,
    Motion,
    Place,
    Rigid,
    WrenchEffect,
)
from lta_sim.kernel import advance, LAYOUT
from lta_sim.model import Model
from lta_sim.state import ACTUATORS, BODY, COMMAND, pack, RIGID
import numpy as np
import pytest
from scipy.spatial.transform import Rotation


def kind(*kinds):
    return [effect for effect in EFFECTS.values() if isinstance(effect, kinds)]


def of(effect):
    return effect.name


def functions(effect):
    match effect:
        case WrenchEffect():
            return [effect.wrench, *([effect.rate] if effect.memory else [])]
        case AirEffect():
            return [effect.air, *([effect.rate] if effect.memory else [])]
        case ActuatorEffect():
            return [effect.output, *([effect.rate] if effect.memory else [])]
        case InertiaEffect():
            return [effect.diagonal]
        case BodyEffect():
            return [effect.change]
        case MeasurementEffect():
            return [effect.reading]


def nulls(effect):
    """Return the null values as the effect's functions see them."""
    return tuple(parameter.null for parameter in seen(effect))


def seen(effect):
    """Return the parameters that one call of the effect's functions sees."""
    return (
        (*effect.shared, *effect.each) if isinstance(effect, ActuatorEffect) else effect.parameters
    )


def reach(parameter):
    """Return values of a parameter that a small vehicle may have."""
    low, high = max(parameter.low, -10.0), min(parameter.high, 10.0)
    return st.floats(min(low, high), max(low, high), allow_subnormal=False)


def parameters(effect):
    """Return values that the effect's own check allows."""
    names = [parameter.name for parameter in seen(effect)]
    return st.tuples(*(reach(parameter) for parameter in seen(effect))).filter(
        lambda values: not effect.check(dict(zip(names, values, strict=True)))
    )


laws = settings(deadline=None, max_examples=50)
number = st.floats(-5.0, 5.0, allow_subnormal=False)
share = st.floats(0.0, 1.0, allow_subnormal=False)
vectors = st.tuples(number, number, number)
thrusts = st.tuples(*[st.floats(-1.0, 1.0, allow_subnormal=False)] * ACTUATORS)


def some(count, values=number):
    return st.tuples(*[values] * count)


surroundings = st.tuples(
    *[number] * 6, st.floats(0.0, 1000.0, allow_subnormal=False), st.floats(0.0, 4.2)
)


@st.composite
def motions(draw):
    turn = Rotation.from_euler('ZYX', draw(vectors))
    rotation = tuple(turn.as_matrix().ravel().tolist())
    rotors = []
    for _ in range(ACTUATORS):
        axis = Rotation.from_euler('ZYX', draw(vectors)).as_matrix()[0]
        rotors += [*draw(vectors), *axis.tolist()]
    body = (draw(share) + 0.1, *draw(some(9)), *draw(some(6, share)), draw(share), *rotors)
    assert len(body) == BODY
    return Motion(
        draw(vectors),
        rotation,
        draw(vectors),
        draw(vectors),
        draw(vectors),
        body,
        draw(some(COMMAND, st.floats(-1.0, 1.0, allow_subnormal=False))),
        draw(surroundings),
    )


places = st.builds(Place, vectors, vectors, vectors, surroundings)


def memories(effect):
    return some(len(effect.memory))


@pytest.mark.parametrize('effect', EFFECTS.values(), ids=of)
def test_parameters_are_declared_in_full(effect):
    names = [parameter.name for parameter in effect.parameters]
    assert len(set(names)) == len(names) > 0
    for parameter in effect.parameters:
        assert UNITS[parameter.unit] == (parameter.unit, 1.0), 'an SI unit of the one table'
        assert math.isfinite(parameter.null)
        assert -math.inf < parameter.low < parameter.high < math.inf
        assert 0.0 < parameter.spread <= parameter.high - parameter.low
        assert len(parameter.source) > 10
    assert effect.check({parameter.name: parameter.null for parameter in effect.parameters}) == ''


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
        assert names == [parameter.name for parameter in seen(effect)]


@pytest.mark.parametrize('effect', kind(WrenchEffect), ids=of)
@laws
@given(data=st.data())
def test_null_gives_no_wrench(effect, data):
    memory = tuple(initial for _, initial in effect.memory)
    motion = data.draw(motions())
    wrench = effect.wrench(nulls(effect), memory, motion, data.draw(thrusts))
    assert wrench == (0.0,) * 6
    remembered = data.draw(memories(effect))
    assert effect.rate(nulls(effect), remembered, motion) == (0.0,) * len(memory)


@pytest.mark.parametrize('effect', kind(AirEffect), ids=of)
@laws
@given(data=st.data())
def test_null_leaves_the_air_alone(effect, data):
    memory, place = tuple(initial for _, initial in effect.memory), data.draw(places)
    assert effect.air(nulls(effect), memory, place) == (0.0,) * 6
    # Vehicles side by side may have it on and off: off, its memory stands in any form.
    remembered = data.draw(memories(effect))
    assert effect.rate(nulls(effect), remembered, place) == (0.0,) * len(memory)


@pytest.mark.parametrize('effect', kind(ActuatorEffect), ids=of)
@laws
@given(data=st.data())
def test_null_passes_the_duty_on(effect, data):
    memory, around = data.draw(memories(effect)), data.draw(surroundings)
    for duty in data.draw(thrusts):
        assert effect.output(nulls(effect), memory, duty, around) == duty
        assert effect.rate(nulls(effect), memory, duty, around) == (0.0,) * len(memory)


@pytest.mark.parametrize('effect', kind(ActuatorEffect), ids=of)
@laws
@given(data=st.data())
def test_no_duty_gives_no_thrust(effect, data):
    memory = tuple(initial for _, initial in effect.memory)
    values = data.draw(parameters(effect))
    assert effect.output(values, memory, 0.0, data.draw(surroundings)) == 0.0


@pytest.mark.parametrize('effect', kind(InertiaEffect), ids=of)
@laws
@given(data=st.data())
def test_inertia_is_never_negative_and_null_is_none(effect, data):
    assert effect.diagonal(nulls(effect)) == (0.0,) * 6
    assert min(effect.diagonal(data.draw(parameters(effect)))) >= 0.0


@pytest.mark.parametrize('effect', kind(BodyEffect), ids=of)
@laws
@given(data=st.data())
def test_null_leaves_the_body_alone(effect, data):
    rigid = Rigid(data.draw(share) + 0.1, data.draw(vectors), data.draw(some(6)), data.draw(share))
    assert effect.change(nulls(effect), rigid) == rigid


@pytest.mark.parametrize('effect', kind(MeasurementEffect), ids=of)
@laws
@given(data=st.data(), time=st.floats(0.0, 1e4))
def test_null_leaves_the_reading_alone(effect, data, time):
    reading = data.draw(some(CHANNELS[effect.channel]))
    assert effect.reading(nulls(effect), reading, time) == reading


@pytest.mark.parametrize('effect', [e for e in kind(WrenchEffect) if e.linear_in], ids=of)
@laws
@given(data=st.data())
def test_linear_parameters_are_linear(effect, data):
    values, motion = data.draw(parameters(effect)), data.draw(motions())
    thrust, memory = data.draw(thrusts), data.draw(memories(effect))
    named = {known.name: value for known, value in zip(effect.parameters, values, strict=True)}
    assert set(effect.linear_in) <= set(named)
    columns = basis(effect, named, motion, thrust, memory)
    linear = np.array([named[name] for name in effect.linear_in])
    wrench = effect.wrench(values, memory, motion, thrust)
    scale = abs(columns) @ abs(linear) + 1.0
    assert np.all(abs(columns @ linear - wrench) <= 1e-12 * scale)


FREE = [effect for effect in kind(WrenchEffect) if not effect.placed]


@pytest.mark.parametrize('effect', FREE, ids=of)
@laws
@given(data=st.data(), heading=st.floats(-3.0, 3.0))
def test_the_room_has_no_preferred_heading(effect, data, heading):
    values, motion = data.draw(parameters(effect)), data.draw(motions())
    thrust, memory = data.draw(thrusts), data.draw(memories(effect))
    turn = Rotation.from_euler('z', heading)
    rotation = turn.as_matrix() @ np.reshape(motion.rotation, (3, 3))
    turned = motion._replace(
        position=tuple(turn.apply(motion.position).tolist()),
        rotation=tuple(rotation.ravel().tolist()),
    )
    one = np.array(effect.wrench(values, memory, motion, thrust))
    two = np.array(effect.wrench(values, memory, turned, thrust))
    np.testing.assert_allclose(two, one, atol=1e-9 * (1.0 + np.max(abs(one))))


DRAG = [
    effect
    for effect in kind(WrenchEffect)
    if effect.name.endswith(('_drag', '_damping', 'cross_flow'))
]


@pytest.mark.parametrize('effect', DRAG, ids=of)
@laws
@given(data=st.data())
def test_drag_dissipates(effect, data):
    motion = data.draw(motions())
    values = data.draw(parameters(effect))
    wrench = np.array(effect.wrench(values, (), motion, data.draw(thrusts)))
    power = wrench * (*motion.airspeed, *motion.rates)
    assert power.sum() <= 1e-12 * abs(power).sum()


@pytest.mark.parametrize('effect', [e for e in kind(ActuatorEffect) if e.memory], ids=of)
@laws
@given(duty=st.floats(-1.0, 1.0), data=st.data())
def test_memory_settles(effect, duty, data):
    values = data.draw(parameters(effect))
    memory, around = tuple(initial for _, initial in effect.memory), data.draw(surroundings)
    step = 0.2 * min([value for value in values if value > 0.0], default=1.0)
    first = effect.rate(values, memory, duty, around)
    for _ in range(2000):
        rates = effect.rate(values, memory, duty, around)
        memory = tuple(m + step * rate for m, rate in zip(memory, rates, strict=True))
    assert math.isfinite(effect.output(values, memory, duty, around))
    assert all(
        abs(late) <= abs(early)
        for late, early in zip(effect.rate(values, memory, duty, around), first, strict=True)
    )


def as_python(effects):
    """Return the kernel of some effects as plain, slow Python."""
    source = kernel_source(effects).replace('from numba import njit', '')
    space = {'njit': lambda **_: lambda function: function}
    exec(source, space)
    return space['advance']


# Values at which each effect of the kernel, and of what surrounds it, changes a flight.
GIVEN = {
    'weight_and_buoyancy': {'gravity': 9.8},
    'added_mass': {'surge': 0.14, 'sway': 0.15, 'heave': 0.37},
    'added_inertia': {'roll': 4e-3, 'pitch': 5e-3},
    'linear_drag': {'surge': 0.01},
    'quadratic_drag': {'surge': 0.09, 'sway': 0.09, 'heave': 0.36},
    'rotational_drag': {'roll': 7e-4, 'pitch': 6e-4, 'yaw': 3e-4, 'roll_2': 2e-3, 'yaw_2': 6e-4},
    'motor_lag': {'up': 0.07, 'down': 0.1},
    'thrust_curve': {'a_1': 0.09, 'b_1': 0.07, 'b_3': 0.1},
    'rotor_thrust': {'heave_1': 0.96, 'surge_3': 0.98},
    'battery_sag': {'voltage': 4.2, 'sensitivity': 0.8},
    'motor_deadband': {'threshold': 0.45},
    'thrust_polynomial': {'voltage': 4.2, 'linear_to': 0.8, 'c_1': 0.05, 'c_3': 0.002},
    'thrust_scale': {'factor': 1.1},
    'rotor_fault': {'lost_1': 0.2},
    'rotor_misalignment': {'first_1': 0.05, 'second_3': -0.03},
    'rotor_envelope_interaction': {
        'heave_2': -0.7,
        'together_yaw': 0.3,
        'share_1': 1.0,
        'share_3': 1.0,
    },
    'net_lift': {'force': 0.02},
    'helium_leak': {'rate': 1e-3},
    'superheat': {'warming': 0.02, 'lag': 60.0, 'slack': 1.0},
    'moving_mass': {'mass': 0.05, 'x': 0.07, 'z': -0.24, 'lag': 0.3, 'speed': 0.2},
    'strip_damping': {'z_1': -0.35, 'half_y_1': 0.16, 'surge_1': 0.01, 'sway_1': 0.004},
    'steady_wind': {'x': 0.5, 'z': 0.1},
    'wind_profile': {'x': 2.0, 'y': -1.0, 'roughness': 0.03, 'half_height': 0.3},
    'wind_gradient': {'x_y': 0.1, 'z_x': -0.2},
    'turbulence': dict.fromkeys(('along', 'across', 'up'), 0.1)
    | dict.fromkeys(('along_length', 'across_length', 'up_length'), 1.0),
    'gusts': {'x': 0.5, 'y': 0.2, 'begin': 0.1, 'length': 1.0},
    'cross_flow': {'horizontal': 1.0, 'total': 0.5, 'sway': 0.09},
    'munk_moment': {'lost': 0.3},
    'hull_lift': {
        'density': 1.2,
        'area': 0.25,
        'drag': 0.24,
        'side_beta': -2.1,
        'lift_alpha': 2.9,
        'pitch': 0.06,
        'yaw_beta': -0.09,
        'roll_rate': 0.05,
    },
    'ground_effect': {'gain': 1.0, 'radius': 0.0235},
    'ceiling_effect': {'gain': 1.0, 'radius': 0.0235, 'height': 2.2},
    'walls': {
        'x_low': -3.0,
        'x_high': 1.45,
        'y_low': -3.0,
        'y_high': 2.48,
        'ceiling': 2.5,
        'radius': 0.5,
        'half_height': 0.3,
        'stiffness': 100.0,
        'relaxation': 0.05,
        'friction': 0.3,
    },
    'floor_contact': {'stiffness': 100.0, 'relaxation': 0.05, 'friction': 0.5, 'z': -0.36},
}
ROTORS = [((0.0, 0.2, -0.3), (0.0, 0.0, 1.0)), ((0.1, 0.0, -0.3), (1.0, 0.0, 0.0))] * 2
COMMANDED = [0.4, -0.2, 0.6, 0.1, 0.0, 0.0, 0.0, 0.0, 0.02, 0.01, -0.3]
AROUND = [0.2, 0.1, 0.0, 3.0, -2.0, 1.0, 400.0, 3.6, 0.1, -0.2, 0.05]
REMEMBERED = 0.3


def flight(effects, kernel, given):
    """Return the state a few steps on, with the memory that these effects have."""
    model = Model.build(
        given,
        mass=0.36,
        cg=(0.01, 0.0, -0.08),
        inertia=np.diag([0.02, 0.02, 0.03]),
        displaced=0.35,
        rotors=ROTORS,
    )
    layout = layout_of(effects)
    places, _ = LAYOUT.places(layout.effects)
    on = [int(model.on[LAYOUT.flag(name)]) for name in layout.effects]
    start = begin([REMEMBERED] * (layout.size - RIGID)).tolist()
    where = row.places(layout)
    numbers = [0.0] * where['wind'].stop
    for name, values in {
        'state': start,
        'parameters': model.parameters[places].tolist(),
        'body': model.body.tolist(),
        'inverse': model.inverse.tolist(),
        'command': COMMANDED,
        'surroundings': AROUND,
    }.items():
        numbers[where[name]] = values
    kernel(numbers, on, 2e-3, 10)
    return model, start, numbers[where['state']]


def begin(memory):
    return pack((1.0, 2.0, 0.33), 0.3, (0.3, -0.2, -0.1), (0.4, 0.5, -0.6), memory)


def test_every_effect_of_the_kernel_is_flown():
    outside = {e.name for e in kind(BodyEffect, MeasurementEffect)}
    assert set(GIVEN) == set(EFFECTS) - outside


@pytest.mark.parametrize('absent', EFFECTS)
def test_null_changes_nothing_to_the_bit(absent):
    """A kernel without the effect and the compiled kernel with it at null are equal."""
    others = {name: effect for name, effect in EFFECTS.items() if name != absent}
    given = {name: values for name, values in GIVEN.items() if name != absent}
    model, _, without = flight(others, as_python(others), given)
    start = begin([REMEMBERED] * len(initial_memory()))
    at_null = advance(start, model, COMMANDED, AROUND, 2e-3, 10)
    np.testing.assert_array_equal(at_null[:RIGID], without[:RIGID])


def test_the_compiled_kernel_equals_its_text_to_the_bit():
    model, start, python = flight(EFFECTS, as_python(EFFECTS), GIVEN)
    compiled = advance(np.array(start), model, COMMANDED, AROUND, 2e-3, 10)
    np.testing.assert_array_equal(compiled, python)


def test_each_effect_of_that_flight_matters():
    kernel = as_python(EFFECTS)
    _, _, everything = flight(EFFECTS, kernel, GIVEN)
    for absent in GIVEN:
        given = {name: values for name, values in GIVEN.items() if name != absent}
        _, _, without = flight(EFFECTS, kernel, given)
        assert np.max(abs(np.subtract(everything, without)[:RIGID])) > 1e-9, absent
