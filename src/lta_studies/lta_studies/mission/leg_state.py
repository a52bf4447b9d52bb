# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define the state of one leg of a mission, and pure functions that advance and assess it.

A leg is a climb and flight to a beacon, a dwell there, or a landing. It works like a batch flight
(`lta_flight.batch`) that can be resumed: `LegState` holds the whole memory of drone and world. The
drone flies by homing (`lta_control.strategies.homing`), with bearings fitted to the amplitudes of
the diodes; no ADC blocks are simulated.
"""

import math
from typing import NamedTuple

from lta_control.allocation import NO_ROTORS
from lta_control.flight_step import is_stopped
from lta_control.laws.protocol import ControlLaw
from lta_control.mission import Phase
from lta_control.strategies.protocol import NavigationStrategy
from lta_flight.batch.batch_flight import FlightConstants
from lta_flight.batch.control_period import (
    FlightInputs,
    FlightKernel,
    FlightMemory,
    simulate_period,
    WorkArrays,
)
from lta_flight.batch.flight import build_command, unreachable_pose
from lta_flight.batch.targets import BatchSchedule
from lta_model.electrical.battery import integrate_charge
from lta_model.model import has_diverged
from lta_sim.compiled_sensors import draw_errors, simulate_range_reading
from lta_sim.termination import is_indoors
import numpy as np
from numpy.typing import NDArray

TRACK_STEPS = 50  # control steps between two poses of a track
ON_FOOT = 0.02  # m above the standing height that still counts as on the ground

FLYING, DONE, LATE, RESERVE, EMPTY, ESCAPED, STOPPED = range(7)
GO, DWELL, LAND = range(3)  # kinds of leg


class LegPlan(NamedTuple):
    """Plan of the next leg."""

    kind: int  # `GO` ends on arrival, `DWELL` after its time, `LAND` on the ground
    limit: float  # time limit of the leg [s]
    reserve: float  # charge estimate at which the leg is broken off [1]
    payload: float  # power of the payload: sensor and its radio [W]
    # Errors of the current meter: factor, and offset in A
    gain: float
    offset: float


class LegState(NamedTuple):
    """Everything that a leg passes on to the next."""

    flight: FlightMemory  # state of vehicle and drone; time and energy count from take-off
    charge: float  # charge estimate of the drone [1]
    first_step: int  # control period at which this leg began
    path: float  # horizontal path since take-off [m]
    lowest: float  # lowest voltage since take-off [V]
    outcome: int  # `FLYING` or how the leg ended


def ground_leg_state(flight: FlightMemory, charge: float) -> LegState:
    """Return the state on the ground from that of the flight and the charge estimate."""
    return LegState(flight, charge, 0, 0.0, flight.supply.flow.voltage, FLYING)


def fly_leg(
    kernel: FlightKernel,
    schedule: BatchSchedule,
    strategy: NavigationStrategy,
    law: ControlLaw,
    constants: FlightConstants,
    leg: LegPlan,
    before: LegState,
    numbers: NDArray[np.float64],
    recorded: NDArray[np.float64],
    seed: int,
    work: WorkArrays,
    track: NDArray[np.float64],
) -> LegState:
    """
    Fly one leg; `numbers` are those of the vehicle's model, `recorded` is empty.

    `track`, shape (n, 8): receives time [s], position [m, map] and attitude x y z w of every
    `TRACK_STEPS`-th step of the flight, as far as it has rows.
    """
    inputs = FlightInputs(
        numbers, recorded, draw_errors(constants.sensors, seed), seed, leg.payload
    )
    flight = _resume_flight(constants, before.flight, inputs)
    now = before._replace(flight=flight)
    while now.outcome == FLYING:
        flight = simulate_period(
            kernel, schedule, strategy, law, constants, now.flight, inputs, work
        )
        now = update_leg(schedule, constants, leg, now, flight)
        row = flight.step // TRACK_STEPS
        if flight.step % TRACK_STEPS == 0 and row < len(track):
            track[row, 0] = flight.step * schedule.period
            for k in range(7):
                track[row, 1 + k] = flight.state[k]
    return now


def _resume_flight(
    constants: FlightConstants, memory: FlightMemory, inputs: FlightInputs
) -> FlightMemory:
    """Return the memory at the start of a leg: reflections of its lamp are not known yet."""
    distance = memory.distance
    if memory.step == 0:
        distance = simulate_range_reading(
            constants.sensors, inputs.errors, inputs.seed, 0, memory.state
        )
    command = build_command(constants, memory.onboard.pilot.law.command.duties)
    return memory._replace(command=command, gathered=unreachable_pose(), distance=distance)


def update_leg(
    schedule: BatchSchedule,
    constants: FlightConstants,
    leg: LegPlan,
    before: LegState,
    flight: FlightMemory,
) -> LegState:
    """Return the state of the leg after a step."""
    charge = meter_charge(
        constants, leg, before.charge, flight.supply.flow.current, schedule.period
    )
    old = before.flight.state
    return LegState(
        flight,
        charge,
        before.first_step,
        before.path + math.hypot(flight.state[0] - old[0], flight.state[1] - old[1]),
        min(before.lowest, flight.supply.flow.voltage),
        assess_leg(
            constants, leg, flight, charge, (flight.step - before.first_step) * schedule.period
        ),
    )


def meter_charge(
    constants: FlightConstants, leg: LegPlan, charge: float, current: float, dt: float
) -> float:
    """Advance the drone's charge estimate with the errors of its current meter."""
    return integrate_charge(
        charge, leg.gain * current + leg.offset, constants.power.supply.parts.cell.capacity, dt
    )


def assess_leg(
    constants: FlightConstants,
    leg: LegPlan,
    flight: FlightMemory,
    charge: float,
    spent: float,
) -> int:
    """Return the outcome of a leg after a time [s]."""
    state, pilot = flight.state, flight.onboard.pilot
    # The order matters: the first condition that holds names the outcome.
    if not flight.supply.flow.fed:
        return EMPTY
    if not is_indoors(constants.goal, state[0], state[1], state[2]):
        return ESCAPED
    if is_stopped(pilot.watch.state) or has_diverged(state):
        return STOPPED
    # A landing goes on below the reserve, so it is assessed before the charge.
    if leg.kind == LAND:
        down = state[2] <= constants.place[2] + ON_FOOT and pilot.law.command.duties == NO_ROTORS
        return DONE if down else LATE if spent >= leg.limit else FLYING
    if leg.kind == GO and flight.mission.phase == Phase.ARRIVED:
        return DONE
    if charge <= leg.reserve:
        return RESERVE
    if spent < leg.limit:
        return FLYING
    # A dwell ends by its time; every other leg that reaches its limit is late.
    return DONE if leg.kind == DWELL else LATE
