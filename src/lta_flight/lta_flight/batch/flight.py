# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Pure functions around the cores of a batch flight, on numbers and tuples.

The order of operations is that of `lta_flight.closed_loop`. The differences: random numbers come
from counters; the lamp's signal is sampled by `lta_sim.light_link` instead of from ADC blocks; the
reserve uses the true charge; and values are not rounded by messages.
"""

import math

from lta_config.constants import STANDARD_GRAVITY
from lta_control.allocation import PerRotor
from lta_control.flight_step import DroneMemory, SensorInputs, UNTRACKED
from lta_control.motion import DeadReckonedMotion, Setpoint, wrap_angle, yaw_from_quaternion
from lta_control.sighting import LampDirection, sight_from_direction
from lta_control.strategies.protocol import LightMeasurement
from lta_flight.batch.batch_flight import (
    FlightConstants,
    FlightTally,
    Vector,
)
from lta_model.electrical.mppt_charger import PowerFlow
from lta_model.light.direct_light import direct_light
from lta_model.light.readings import daylight_on_panel, lamp_light_on_panel
from lta_model.light.scene_geometry import daylight_illuminance, is_in_room
from lta_model.model import has_diverged
from lta_model.sensors.imu import specific_force_at
from lta_model.state import RIGID
from lta_sim.compiled_sensors import (
    draw_uniforms,
    SensorErrors,
    simulate_imu_reading,
    simulate_pressure_reading,
    START,
)
from lta_sim.supply import SupplyState
from lta_sim.termination import (
    distance_to_goal,
    evaluate_outcome,
    FLYING,
    GoalProgress,
    LIFT_OFF,
)
from lta_vlc.direction_fit import DirectionFit
from lta_vlc.lamp import RAYLEIGH_SHARE

State = tuple[float, ...]
Pose = tuple[float, float, float, float, float, float, float]  # position [m], quaternion
MOVED_DISTANCE = 1.0  # m of motion after which reflections are computed again
TURNED = math.cos(0.5 * 0.35) ** 2  # the same for a rotation by 0.35 rad
HELD_RATE = (0.0,) * RIGID  # derivative of the state of a held drone

RAN_AWAY = 4  # the integration diverged; not one of the outcomes


def initial_supply(store: PowerFlow) -> SupplyState:
    """Return a supply before the first step, from the state of the power path."""
    return SupplyState(store, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def unreachable_pose() -> Pose:
    """Return an infinitely distant pose, which makes `has_moved` true."""
    return (math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def has_moved(pose: Pose, gathered: Pose) -> bool:
    """Return whether reflections must be computed again (direct light always is)."""
    x, y, z = pose[0] - gathered[0], pose[1] - gathered[1], pose[2] - gathered[2]
    # Negated, so that an infinite or NaN distance counts as motion.
    if not x * x + y * y + z * z < MOVED_DISTANCE * MOVED_DISTANCE:
        return True
    # The dot product of two quaternions is the cosine of half the angle between them;
    # squared, because q and -q are the same attitude.
    same = 0.0
    for k in range(3, 7):
        same += pose[k] * gathered[k]
    return same * same < TURNED


def draw_initial_state(constants: FlightConstants, seed: int) -> State:
    """Return the rigid part of the state: at rest, with a random heading."""
    # The random stream START is used for nothing else
    share, _ = draw_uniforms(seed, START, 0, 0)
    # Half of the heading, for a quaternion about z
    half = 0.5 * (constants.heading + constants.spread * (2.0 * share - 1.0))
    x, y, z = constants.place
    return (
        x, y, z, 0.0, 0.0, math.sin(half), math.cos(half), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )  # fmt: skip


def clip_duty(duty: float, low: float) -> float:
    """Return a duty limited to the range of a rotor."""
    return min(max(duty, low), 1.0)


def build_command(constants: FlightConstants, u: PerRotor) -> tuple[float, ...]:
    """Return a command in the form of the kernel."""
    low, (x, y, z) = constants.lowest, constants.mass_place
    return (
        # Written out, because compiled code has no generic tuples
        clip_duty(u[0], low[0]), clip_duty(u[1], low[1]),
        clip_duty(u[2], low[2]), clip_duty(u[3], low[3]),
        clip_duty(u[4], low[4]), clip_duty(u[5], low[5]),
        clip_duty(u[6], low[6]), clip_duty(u[7], low[7]),
        x, y, z,
    )  # fmt: skip


def read_sensors(
    constants: FlightConstants,
    errors: SensorErrors,
    seed: int,
    step: int,
    elapsed: float,
    force: Vector,
    rates: Vector,
    state: State,
    distance: float,
    pressure_due: bool,
) -> SensorInputs:
    """Return the inputs of the estimator; force and rates are those at the IMU."""
    felt, turned = simulate_imu_reading(errors, seed, step, force, rates)
    # NaN where no sample is due
    pressure = math.nan
    if pressure_due:
        pressure = simulate_pressure_reading(constants.sensors, errors, seed, step, state, elapsed)
    return SensorInputs(turned, felt, distance, pressure, UNTRACKED, False)


def sensor_specific_force(
    constants: FlightConstants, state: State, rate: State, held: bool
) -> Vector:
    """Return the specific force at the IMU; a held drone does not accelerate [m/s2]."""
    place = constants.sensors.imu_place
    if held:
        return specific_force_at(state, HELD_RATE, place, STANDARD_GRAVITY)
    return specific_force_at(state, rate, place, STANDARD_GRAVITY)


def with_setpoint(memory: DroneMemory, setpoint: Setpoint) -> DroneMemory:
    """Return the drone's memory with a new setpoint."""
    return memory._replace(guided=True, setpoint=setpoint)


def ambient_irradiance(constants: FlightConstants, position: Vector) -> float:
    """Return the ambient light at a place: beyond a door there is none [W/m2]."""
    listening, (x, y, z) = constants.listening, position
    if listening.door and not is_in_room(listening.around, x, y, z):
        return 0.0
    return constants.power.ambient


def panel_irradiance(constants: FlightConstants, state: State) -> float:
    """Return the irradiance of sunlight that gives the panel its current now [W/m2]."""
    position, q = (state[0], state[1], state[2]), (state[3], state[4], state[5], state[6])
    power, lamps, around = constants.power, constants.listening.lamps, constants.listening.around
    bright = 0.0
    for k in range(len(lamps)):
        light = lamp_light_on_panel(power.panel, around, lamps[k], position, q)
        bright += power.panel_weights.lamps[k] * power.lamp_shares[k] * light
    day = power.day_share * daylight_on_panel(power.panel, around, position, q)
    ambient = power.panel.share * ambient_irradiance(constants, position)
    return bright + power.panel_weights.day * day + power.panel_weights.ambient * ambient


def hull_irradiance(constants: FlightConstants, state: State) -> float:
    """Return the irradiance at the hull centre on planes facing each light [W/m2]."""
    power, lamps, s = constants.power, constants.listening.lamps, constants.listening.around
    light = 0.0
    for k in range(len(lamps)):
        direct = direct_light(lamps[k], (state[0], state[1], state[2]))[0]
        light += power.lamp_shares[k] * (direct + lamps[k].diffuse)
    day = daylight_illuminance(s, (state[0], state[1], state[2]), (s.sun_x, s.sun_y, s.sun_z))
    ambient = ambient_irradiance(constants, (state[0], state[1], state[2]))
    return light + ambient + power.day_share * day


def initial_tally(constants: FlightConstants) -> FlightTally:
    """Return the tally before the first step."""
    x, y, _ = constants.place
    progress = GoalProgress(0, True, math.inf)
    away = distance_to_goal(constants.goal, progress, x, y)
    return FlightTally(FLYING, progress, math.nan, math.nan, 0.0, away, 0.0, 0.0, 0.0, 0.0)


def amplitude_error(amplitude: float, snr: float) -> float:
    """Return the standard deviation of a reading due to noise, as `lta_vlc.lamp` [counts]."""
    return RAYLEIGH_SHARE * amplitude / snr if snr > 0.0 else math.inf


def is_lamp_detected(snrs: tuple[float, ...], threshold: float) -> bool:
    """Return whether the SNR of any diode reaches the threshold."""
    for snr in snrs:  # noqa: SIM110 - compilable
        if snr >= threshold:
            return True
    return False


def sight_from_fit(
    constants: FlightConstants,
    fit: DirectionFit,
    detected: bool,
    amplitudes: tuple[float, ...],
    reckoned: DeadReckonedMotion,
    interval: float,
) -> LightMeasurement:
    """Return the sight of a light block from the fit to its amplitudes."""
    lamp = LampDirection(False, 0.0, 0.0, 0.0)
    if detected and fit.found:
        lamp = LampDirection(
            True,
            math.atan2(fit.y, fit.x),
            math.atan2(fit.z, math.hypot(fit.x, fit.y)),
            math.sqrt(max(fit.azimuth_variance, 0.0)),
        )
    return sight_from_direction(
        lamp, constants.listening.axes, amplitudes, reckoned, interval, constants.diode_scale
    )


def update_tally(
    constants: FlightConstants,
    tally: FlightTally,
    before: tuple[float, float],
    state: State,
    supply: SupplyState,
    elapsed: float,
    dt: float,
) -> FlightTally:
    """Return the tally after one more control period, which began at the position `before` [m]."""
    x, y, z = state[0], state[1], state[2]
    outcome, progress = evaluate_outcome(constants.goal, tally.progress, x, y, z, elapsed)
    # Of the lamp that is targeted last
    closest = tally.closest if progress.stop == tally.progress.stop else math.inf
    lift_off, energy = tally.lift_off, tally.energy
    # Energy counts from lift-off on, as in the results
    if math.isfinite(lift_off):
        # A discharging current is negative
        energy -= supply.flow.voltage * supply.flow.current * dt
    elif z > constants.place[2] + LIFT_OFF:
        lift_off = elapsed
    return FlightTally(
        RAN_AWAY if has_diverged(state) else outcome,
        progress,
        lift_off,
        tally.search_start,
        tally.path_length + math.hypot(x - before[0], y - before[1]),
        min(closest, distance_to_goal(constants.goal, progress, x, y)),
        energy,
        tally.blocks,
        tally.bearings,
        tally.squares,
    )


def update_light_tally(
    constants: FlightConstants,
    tally: FlightTally,
    middle: Pose,
    detected: bool,
    angle: float,
    speed: float,
    began: float,
) -> FlightTally:
    """
    Return the tally after a light block that began at `began` [s].

    `middle` is the true pose in the middle of the block, to which the measured direction belongs.
    """
    # The search starts with the first forward setpoint, as in the results
    search_start = tally.search_start
    if not math.isfinite(search_start) and speed > 0.0:
        search_start = began
    blocks, bearings, squares = tally.blocks, tally.bearings, tally.squares
    if math.isfinite(search_start):
        blocks += 1.0
        if detected:
            q = (middle[3], middle[4], middle[5], middle[6])
            lamp = constants.goal.stops[tally.progress.stop]
            true = math.atan2(lamp[1] - middle[1], lamp[0] - middle[0]) - yaw_from_quaternion(q)
            bearings += 1.0
            squares += wrap_angle(angle - true) ** 2
    return FlightTally(
        tally.outcome, tally.progress, tally.lift_off, search_start, tally.path_length,
        tally.closest, tally.energy, blocks, bearings, squares,
    )  # fmt: skip
