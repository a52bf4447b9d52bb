# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Laws over every registered effect, built in or installed, each by itself."""

import ast
from functools import cache
import inspect
import math
import textwrap

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_config.quantity import SI_UNITS
from lta_discovery.model.candidates import companion_values, DESIGN, JOINT_PARAMETERS, NO_CANDIDATE
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    AirEffectInput,
    BodyEffect,
    CHANNEL_SIZES,
    InertiaEffect,
    MeasurementEffect,
    RigidBody,
    VehicleMotion,
    WrenchEffect,
)
from lta_model.state import ACTUATORS, BODY, COMMAND
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


@cache  # Hypothesis validates each new strategy object, which takes time
def parameters(effect):
    """Return values that the effect's own check allows."""
    names = [parameter.name for parameter in seen(effect)]
    return st.tuples(*(reach(parameter) for parameter in seen(effect))).filter(
        lambda values: not effect.check(dict(zip(names, values, strict=True)))
    )


laws = settings(deadline=None, max_examples=25)
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
    """Draw what moves with its edges one by one, and the hundred numbers of the body by a seed."""
    turn = Rotation.from_euler('ZYX', draw(vectors))
    rotation = tuple(turn.as_matrix().ravel().tolist())
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    turns = Rotation.from_euler('ZYX', generator.uniform(-5.0, 5.0, (ACTUATORS, 3)))
    where = generator.uniform(-5.0, 5.0, (ACTUATORS, 3))
    rotors = np.hstack([where, turns.as_matrix()[:, 0]]).ravel().tolist()
    moments = generator.uniform(-5.0, 5.0, 9).tolist()
    added = generator.uniform(0.0, 1.0, 6).tolist()
    body = (draw(share) + 0.1, *moments, *added, draw(share), *rotors)
    assert len(body) == BODY
    commanded = tuple(generator.uniform(-1.0, 1.0, COMMAND).tolist())
    return VehicleMotion(
        draw(vectors),
        rotation,
        draw(vectors),
        draw(vectors),
        draw(vectors),
        body,
        commanded,
        draw(surroundings),
    )


places = st.builds(AirEffectInput, vectors, vectors, vectors, surroundings)


@cache
def memories(effect):
    return some(len(effect.memory))


@pytest.mark.parametrize('effect', EFFECTS.values(), ids=of)
def test_parameters_are_declared_in_full(effect):
    names = [parameter.name for parameter in effect.parameters]
    assert len(set(names)) == len(names) > 0
    for parameter in effect.parameters:
        assert SI_UNITS.get(parameter.unit) == (parameter.unit, 1.0), (
            f"'{parameter.unit}' is no SI unit of config/lta_config/quantity.py; a new one is a "
            'line there'
        )
        assert math.isfinite(parameter.null)
        assert -math.inf < parameter.low < parameter.high < math.inf
        assert 0.0 < parameter.spread <= parameter.high - parameter.low
        assert len(parameter.source) > 10
    assert effect.check({parameter.name: parameter.null for parameter in effect.parameters}) == ''


@pytest.mark.parametrize('effect', EFFECTS.values(), ids=of)
def test_its_docstring_tells_what_it_is(effect):
    assert EFFECTS[effect.name] is effect
    about = inspect.getdoc(functions(effect)[0]) or ''
    assert '=' in about, 'the equations stand in the docstring of the main function'


@pytest.mark.parametrize('effect', EFFECTS.values(), ids=of)
def test_functions_unpack_the_parameters_in_their_order(effect):
    for function in functions(effect):
        names = tuple(parameter.name for parameter in seen(effect))
        tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        read, local = (), {'p': names}
        for node in tree.body:
            if isinstance(node, ast.Assign) and 'p' in {
                each.id for each in ast.walk(node.value) if isinstance(each, ast.Name)
            }:
                exec(ast.unparse(node), {}, local)
                for target in ast.walk(node.targets[0]):
                    if isinstance(target, ast.Name):
                        value = local[target.id]
                        assert isinstance(value, tuple) or value == target.id
                        read += value if isinstance(value, tuple) else (value,)
        assert read == names


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
    values, around = data.draw(parameters(effect)), data.draw(surroundings)
    assert effect.output(values, memory, 0.0, around) == 0.0
    # So that a batch may leave out rotors without a command and a memory
    still = (0.0,) * len(memory)
    assert effect.output(values, still, 0.0, around) == 0.0
    assert effect.rate(values, still, 0.0, around) == still


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
    rigid = RigidBody(
        data.draw(share) + 0.1, data.draw(vectors), data.draw(some(6)), data.draw(share)
    )
    assert effect.change(nulls(effect), rigid) == rigid


@pytest.mark.parametrize('effect', kind(MeasurementEffect), ids=of)
@laws
@given(data=st.data(), time=st.floats(0.0, 1e4))
def test_null_leaves_the_reading_alone(effect, data, time):
    reading = data.draw(some(CHANNEL_SIZES[effect.channel]))
    assert effect.reading(nulls(effect), reading, time) == reading


@pytest.mark.parametrize('effect', [e for e in kind(WrenchEffect) if e.linear_in], ids=of)
@laws
@given(data=st.data())
def test_linear_parameters_are_linear(effect, data):
    values, motion = data.draw(parameters(effect)), data.draw(motions())
    thrust, memory = data.draw(thrusts), data.draw(memories(effect))
    named = {known.name: value for known, value in zip(effect.parameters, values, strict=True)}
    assert set(effect.linear_in) <= set(named)
    linear = np.array([named[name] for name in effect.linear_in])
    # Column j is the wrench at the unit vector j of the linear parameters, the others held
    units = ({**named, **dict.fromkeys(effect.linear_in, 0.0), name: 1.0}
             for name in effect.linear_in)  # fmt: skip
    columns = np.column_stack(
        [effect.wrench(tuple(unit.values()), memory, motion, thrust) for unit in units]
    )
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


def anything(effect, generator):
    """Return something of everything else that the functions of an effect are given."""
    number = lambda count, low=-5.0, high=5.0: tuple(generator.uniform(low, high, count).tolist())  # noqa: E731
    memory = number(len(getattr(effect, 'memory', ())))
    around = (*number(6), *number(1, 0.0, 1000.0), *number(1, 2.5, 4.2))
    match effect:
        case WrenchEffect():
            turn = Rotation.from_euler('ZYX', number(3)).as_matrix().ravel()
            body = (1.0, *number(9), *number(6, 0.0, 1.0), 0.4, *number(6 * ACTUATORS))
            moving = (tuple(turn.tolist()), number(3), number(3), number(3))
            motion = VehicleMotion(number(3), *moving, body, number(COMMAND), around)
            return memory, motion, number(ACTUATORS, -1.0, 1.0)
        case AirEffect():
            return memory, AirEffectInput(number(3), number(3), number(3), around)
        case ActuatorEffect():
            return memory, *number(1, 0.0, 1.0), around
        case InertiaEffect():
            return ()
        case BodyEffect():
            return (RigidBody(1.0, number(3), number(6), 0.4),)
        case MeasurementEffect():
            return number(CHANNEL_SIZES[effect.channel]), *number(1, 0.0, 1e4)


def answers(effect, values, given):
    """Return what the functions of an effect say."""
    said = [functions(effect)[0](values, *given)]
    if len(functions(effect)) > 1:
        said.append(effect.rate(values, *given[: 2 if isinstance(effect, WrenchEffect) else None]))
    return said


# Of the drag along each axis, which a vehicle has, it makes one across: no constant stands beside.
ALONE = [e for e in EFFECTS.values() if e.name not in {*DESIGN, 'cross_flow'}]


@pytest.mark.parametrize('effect', ALONE, ids=of)
def test_each_candidate_does_something_alone(effect):
    """As discovery tries it on a vehicle that lacks the effect: what is `beside` it given."""
    generator = np.random.default_rng(1)
    scenes = [anything(effect, generator) for _ in range(200)]
    taken = {p.name: p.null for p in seen(effect)} | companion_values(effect.name)
    together = JOINT_PARAMETERS.get(effect.name, ())
    for parameter in seen(effect):
        if f'{effect.name}.{parameter.name}' in NO_CANDIDATE or parameter.beside is not None:
            continue
        moved = {parameter.name, *(together if parameter.name in together else ())}
        tries = []
        for by in (0.0, 1.0, -1.0):
            off = {
                p.name: min(max(taken[p.name] + by * p.spread, p.low), p.high)
                for p in seen(effect)
                if p.name in moved and by
            }
            tries.append(tuple((taken | off).values()))
        assert any(
            len({str(answers(effect, values, scene)) for values in tries}) > 1 for scene in scenes
        ), (
            f'{effect.name}.{parameter.name} alone does nothing: say of the number that it needs '
            'what that is taken to be (Parameter(..., beside=...))'
        )
