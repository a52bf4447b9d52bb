# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly a simulated flight to its end, as plain functions that are compiled for a batch."""

from lta_control.allocation import NO_ROTORS
from lta_control.flight_step import is_stopped
from lta_control.laws.protocol import ControlLaw
from lta_control.strategies.protocol import NavigationStrategy
from lta_flight.batch.batch_flight import FlightConstants, FlightTally
from lta_flight.batch.control_period import (
    begin_flight,
    FlightInputs,
    FlightKernel,
    FlightMemory,
    is_block_end,
    simulate_period,
    WorkArrays,
)
from lta_flight.batch.flight import (
    build_command,
    draw_initial_state,
    initial_tally,
    RAN_AWAY,
    update_light_tally,
    update_tally,
)
from lta_flight.batch.targets import BatchSchedule
from lta_model.electrical.mppt_charger import resting_flow
from lta_sim.compiled_sensors import draw_errors, simulate_range_reading
from lta_sim.termination import FLYING
import numpy as np
from numpy.typing import NDArray

# Names of the numbers that `fly` returns
FIGURES = (
    'outcome', 'end', 'lift_off', 'search_start', 'path_length', 'closest', 'energy', 'blocks',
    'bearings', 'squares', 'charge', 'x', 'y', 'z', 'stopped',
)  # fmt: skip
FlightEnd = tuple[float, float, float, float, float, float]


def fly(
    kernel: FlightKernel,
    schedule: BatchSchedule,
    strategy: NavigationStrategy,
    law: ControlLaw,
    constants: FlightConstants,
    numbers: NDArray[np.float64],
    recorded: NDArray[np.float64],
    seed: int,
    work: WorkArrays,
) -> tuple[float, ...]:
    """Fly one vehicle to the end of its flight; return its `FIGURES`."""
    inputs = FlightInputs(numbers, recorded, draw_errors(constants.sensors, seed), seed, 0.0)
    state = kernel.add_effects(draw_initial_state(constants, seed), seed)
    memory = begin_flight(
        strategy,
        kernel.begin,
        state,
        build_command(constants, NO_ROTORS),
        kernel.dark,
        resting_flow(constants.power.charge),
        simulate_range_reading(constants.sensors, inputs.errors, seed, 0, state),
    )
    tally, end = initial_tally(constants), read_end(schedule, memory)
    # As in the loop, the light block in which the flight ends is completed
    while tally.outcome == FLYING or is_block_open(schedule, tally, memory.step):
        before, flying = memory, tally.outcome == FLYING
        memory = simulate_period(kernel, schedule, strategy, law, constants, before, inputs, work)
        began = (before.step - schedule.light) * schedule.period
        # It counts if its middle is in the flight
        counts = flying or began + 0.5 * schedule.block_time <= end[0]
        if is_block_end(schedule, before.step) and counts:
            tally = update_light_tally(
                constants, tally, memory.middle, memory.seen, memory.bearing,
                memory.setpoint.speed, began,
            )  # fmt: skip
        if flying:
            tally = update_tally(
                constants, tally, (before.state[0], before.state[1]), memory.state, memory.supply,
                memory.step * schedule.period, schedule.period,
            )  # fmt: skip
            end = read_end(schedule, memory)
    return (
        1.0 * tally.outcome, end[0], tally.lift_off, tally.search_start, tally.path_length,
        tally.closest, tally.energy, tally.blocks, tally.bearings, tally.squares, end[1], end[2],
        end[3], end[4], end[5],
    )  # fmt: skip


def read_end(schedule: BatchSchedule, memory: FlightMemory) -> FlightEnd:
    """Return time [s], charge, position [m] and whether the motors stopped, as numbers."""
    x, y, z = memory.state[0], memory.state[1], memory.state[2]
    stopped = 1.0 * is_stopped(memory.onboard.pilot.watch.state)
    return memory.step * schedule.period, memory.supply.flow.charge, x, y, z, stopped


def is_block_open(schedule: BatchSchedule, tally: FlightTally, step: int) -> bool:
    """Return whether the light block of a flight that has ended is still in progress."""
    return tally.outcome != RAN_AWAY and (step - 1) % schedule.light > 0
