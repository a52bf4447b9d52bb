# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Laws over every registered control law: duties that rotors can obey, and the same compiled."""

from functools import cache
import math

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_config.compilation.flat import compile_core, TupleLayout
from lta_config.files import list_shipped_names
from lta_control.allocation import create_working_array, DUTY_SCRATCH
from lta_control.laws import find_control_law, LAWS, load_law_gains
from lta_control.laws.protocol import LawInputs
from lta_control.motion import ControlMotion, quaternion_from_angles, Setpoint
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

BY_LAW = {load_vehicle(name).file.control.law: name for name in list_shipped_names('vehicles')}
HEARD = TupleLayout(LawInputs())

anything = st.floats(-1e3, 1e3)
angle = st.floats(-math.pi, math.pi)
vectors = st.tuples(anything, anything, anything)
attitudes = st.builds(quaternion_from_angles, angle, angle, angle)
motions = st.builds(ControlMotion, vectors, attitudes, vectors, vectors)
setpoints = st.builds(Setpoint, anything, anything, anything)
flights = st.lists(
    st.builds(LawInputs, motions, setpoints, st.floats(1e-3, 0.1)), min_size=1, max_size=6
)


@cache
def made(name):
    vehicle = load_vehicle(BY_LAW[name])
    found = find_control_law(name)
    gains = load_law_gains(found.gains, vehicle.file.control.gains)
    return vehicle, found, found.build_constants(gains, vehicle)


def test_every_law_has_a_vehicle():
    assert set(BY_LAW) == set(LAWS)


@pytest.mark.parametrize('name', LAWS)
@settings(max_examples=60, deadline=None)
@given(flight=flights)
def test_whatever_comes_the_duties_are_ones_that_the_rotors_can_obey(name, flight):
    vehicle, found, constants = made(name)
    memory, scratch = found.start, create_working_array()
    count = len(vehicle.rotors)
    for heard in flight:
        memory = found.step(constants, memory, heard, scratch)
        duties = memory.command.duties
        assert all(map(math.isfinite, (*duties, *memory.command.mass_place)))
        for rotor, duty in zip(vehicle.rotors, duties, strict=False):
            assert (-1.0 if rotor.reversible else 0.0) - 1e-9 <= duty <= 1.0 + 1e-9
        assert duties[count:] == (0.0,) * (len(duties) - count)
        if vehicle.file.moving_mass:
            low, high = vehicle.file.moving_mass.low, vehicle.file.moving_mass.high
            assert low.vector[0] <= memory.command.mass_place[0] <= high.vector[0]


@pytest.mark.long  # a quarter of a minute each; the law of a blimp is one in test_compiled.py
@pytest.mark.parametrize('name', LAWS)
@settings(max_examples=20, deadline=None)
@given(flight=flights)
def test_compiled_it_is_the_same_to_the_last_bit(name, flight):
    _, found, constants = made(name)
    layout, form = TupleLayout(constants), TupleLayout(found.start)
    step = compile_core(found.step, layout, form, HEARD)
    numbers, array = layout.write(constants), form.write(found.start)
    memory, scratch = found.start, create_working_array()
    for heard in flight:
        memory = found.step(constants, memory, heard, scratch)
        step(numbers, array, HEARD.write(heard), np.zeros(DUTY_SCRATCH))
        assert form.write(memory).tobytes() == array.tobytes()
