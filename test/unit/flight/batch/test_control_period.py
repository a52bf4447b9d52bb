# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The step of a batch flight as plain Python, with a vehicle that does not move."""

from lta_config.topics import load_topic_table
from lta_control.allocation import NO_ROTORS, pad_to_slots
from lta_control.flight_step import DroneMemory
from lta_flight.batch.batch_flight import build_flight, build_schedule
from lta_flight.batch.control_period import (
    advance_vehicle,
    begin_flight,
    FlightInputs,
    FlightKernel,
)
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.electrical.mppt_charger import resting_flow
from lta_model.state import ACTUATORS, pack_state, RIGID
from lta_sim.compiled_sensors import draw_errors
import numpy as np
import pytest

TABLE = load_topic_table()
DUTIES = (0.1, 0.2, 0.0, 0.0)
STILL = FlightKernel(
    dark=(0.0,) * 8,
    begin=DroneMemory(),
    turbulence=False,
    superheat=False,
    rates=lambda *_: (0.0,) * RIGID,
    thrusts_of=lambda *_: NO_ROTORS,
    ahead=lambda state, *_: state,
    mean=lambda a, *_: a,
    normalised=lambda state: state,
)


@pytest.fixture(scope='module')
def flight():
    stack = build_vehicle_scenario_stack(load_spec('gtmab', 'lamp_room', 'bag', 'gtmab'))
    return build_flight(*stack, TABLE)


def advanced(flight, fed):
    """Return the command after one period with the duties of a pilot."""
    constants = flight.craft
    state = tuple(pack_state((0.0, 0.0, 1.0), 0.0)[:RIGID].tolist())
    store = resting_flow(0.8)._replace(fed=fed)
    onboard = DroneMemory()
    law = onboard.pilot.law
    law = law._replace(command=law.command._replace(duties=pad_to_slots(DUTIES)))
    onboard = onboard._replace(pilot=onboard.pilot._replace(law=law))
    memory = begin_flight(flight.strategy, onboard, state, (0.0,) * 11, STILL.dark, store, 1.0)
    inputs = FlightInputs(np.zeros(1), np.empty((0, 6)), draw_errors(constants.sensors, 1), 1, 0.0)
    after = advance_vehicle(
        STILL, build_schedule(TABLE), constants, memory, inputs, (0.0,) * ACTUATORS
    )
    assert after.step == 1
    return after.command[: len(DUTIES)]


def test_motors_stop_without_power_and_run_again_with_it(flight):
    assert advanced(flight, fed=True) == DUTIES
    assert advanced(flight, fed=False) == (0.0,) * len(DUTIES)
    assert advanced(flight, fed=True) == DUTIES
