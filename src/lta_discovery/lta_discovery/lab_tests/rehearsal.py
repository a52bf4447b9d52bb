# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Rehearse a test with the model of a vehicle file, and measure what its poses would teach.

A rehearsal flies the commands of the test open loop. What its poses teach is computed with the
filter of a calibration.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, Literal

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import ALL_CHANNELS, GRID_PERIOD, MeasuredFlight, Stream
from lta_discovery.lab_tests.design import LabTest, rest_duties, step_duties, STEP_REST
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.replay import FlightReplay, STEPS_PER_PERIOD
from lta_discovery.state_filter.kalman import filter_flight
from lta_discovery.state_filter.likelihood import linearize_all
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel, wrench_floor
from lta_discovery.state_filter.smoothing import smooth_flight
from lta_model.effects.protocol import AXES
from lta_model.state import ACTUATORS
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Commands = Literal['rotors', 'wrench']

POSE_NOISE: Final = 1e-3  # m; noise of a tracker of passive markers
TURN_NOISE: Final = 2.5e-3  # rad
PILOT_HOLD_TIMES: Final = (0.4, 1.6)  # s; shortest and mean time for which a pilot holds a command
HIGH: Final = 100.0  # m; rehearsals never meet the floor
FREE_FLIGHT_SEED: Final = 37  # of the commands of the free flight
SMOOTHED: Final = 3  # times; each leaves the square of the error that the one before left


def rehearse_test(
    vehicle: Vehicle, nominal: NominalVehicle, test: LabTest, commands: Commands
) -> MeasuredFlight:
    """Return the flight of a test with the model of the vehicle file, as a tracker sees it."""
    count = round(test.seconds / GRID_PERIOD)
    time = GRID_PERIOD * np.arange(count + 1, dtype=np.float64)
    weight = vehicle.heaviness * STANDARD_GRAVITY
    if test.is_neutral:
        nominal = nominal.with_value('net_lift', 'force', weight)
    duties, wrench = build_commands(vehicle, test, commands, weight)
    blank = MeasuredFlight(
        time,
        np.zeros((count + 1, 3)),
        np.tile([0.0, 0.0, 0.0, 1.0], (count + 1, 1)),
        np.full((count + 1, 8), np.nan),
        np.array([POSE_NOISE] * 3 + [TURN_NOISE] * 3 + [np.inf] * (len(ALL_CHANNELS) - 6)),
        np.ones(count + 1, dtype=np.bool_),
        duties,
        np.full(count + 1, np.nan),
        wrench,
    )
    start = _release_state(test)[None]
    replay = FlightReplay(blank, np.array([0]), count, vehicle.pack_command(()))
    rows = replay.build_replay_rows(nominal)
    none = np.zeros((1, replay.span, len(AXES)))
    inputs = replay.compute_body_inputs(rows)
    states = replay.integrate_pieces(rows, inputs, start, none)[0, ::STEPS_PER_PERIOD]
    return replace(blank, position=states[:, :3].copy(), quaternion=states[:, 3:7].copy())


def _release_state(test: LabTest) -> Array:
    """Return the state in which a vehicle is let go."""
    state = np.zeros(13)
    state[2] = HIGH
    state[6] = np.cos(0.5 * test.tilt)
    if test.tilt:
        state[3 + ('roll', 'pitch', 'yaw').index(test.axis)] = np.sin(0.5 * test.tilt)
    state[12] = test.rate
    return state


def build_commands(
    vehicle: Vehicle, test: LabTest, commands: Commands, weight: float
) -> tuple[Stream, Stream | None]:
    """Return the duties and the commanded wrench of a test."""
    time, levels = _list_levels(test)
    duties = np.zeros((len(time), len(vehicle.rotors)))
    if commands == 'wrench':
        wrench = np.zeros((len(time), len(AXES)))
        for step, level in levels:
            wrench[:, AXES.index(step.axis)] = step.size * level
        if not test.is_neutral:
            wrench[:, AXES.index('heave')] += weight
        return Stream(time[:1], duties[:1, :ACTUATORS]), Stream(time, wrench)
    if not test.is_neutral:
        rest = np.array(rest_duties(vehicle))
        duties += rest
        for step, level in levels:
            duties += level[:, None] * (np.array(step_duties(vehicle, step)) - rest)
    lowest = [-1.0 if rotor.reversible else 0.0 for rotor in vehicle.rotors]
    return Stream(time, np.clip(duties, lowest, 1.0)[:, :ACTUATORS]), None


def _list_levels(test: LabTest) -> tuple[Array, list[tuple[LabTest, Array]]]:
    """Return times [s], and the level of each step: 1 is the whole of it."""
    if test.kind == 'step':
        return np.array([0.0, STEP_REST]), [(test, np.array([0.0, 1.0]))]
    if test.kind != 'free_flight':
        return np.zeros(1), []
    draw = np.random.default_rng(FREE_FLIGHT_SEED)
    time = np.arange(0.0, test.seconds, PILOT_HOLD_TIMES[0])
    levels = []
    for step in test.parts:
        # A pilot holds each command for a while, on each axis by itself
        held = np.cumsum(draw.random(len(time)) < PILOT_HOLD_TIMES[0] / PILOT_HOLD_TIMES[1])
        levels.append((step, draw.choice([-1.0, 0.0, 1.0], len(time))[held - held[0]]))
    return time, levels


def path_extent(flight: MeasuredFlight) -> tuple[float, float]:
    """Return the horizontal and the vertical extent of a path [m]."""
    x, y, z = np.ptp(flight.position, axis=0)
    return float(np.hypot(x, y)), float(z)


def measure_information(
    flight: MeasuredFlight,
    vehicle: Vehicle,
    nominal: NominalVehicle,
    parameters: Sequence[FreeParameter],
) -> Array:
    """
    Return the information of all readings of a flight about K parameters, shape (K, K).

    `nominal`: about which it is linearized. The unexplained wrench is at the noise floor, as
    nothing is missing in a simulation. About a smoothed motion, the first state turns with the
    frames of tracker and markers; otherwise its prior would seem to tell of them.
    """
    noise = replace(NoiseModel.guess(nominal, flight), wrench=wrench_floor(nominal))
    system = FlightSystem(vehicle, flight, [])
    for _ in range(SMOOTHED):
        (linear,) = linearize_all([system], nominal, np.zeros(0))
        smooth = smooth_flight(linear, noise, np.zeros(0))
        system = system.with_motion(smooth.motion, smooth.wrench, nominal)
    system = system.with_parameters(parameters)
    (linear,) = linearize_all([system], nominal, np.zeros(len(parameters)))
    return filter_flight(linear, noise).products[:-1, :-1]
