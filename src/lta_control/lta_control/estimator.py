# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate the drone's motion from its own sensors and commands.

At rest on level ground the estimator first calibrates the IMU biases and the floor pressure
(`rest_time`), and starts again if the drone is moved. It waits while the biases are larger than
the sensor allows. After `REST_PATIENCE` rest times it accepts a tilt, since an unbalanced drone
stands tilted, but never a turn: a false yaw bias would turn the estimate for the whole flight.
Then it filters attitude, altitude and airspeed at each step. A range finder or barometer that
repeats its reading to the bit is stuck and not used. The position here is dead reckoning through
the air; that over ground is estimated from it (`ground_motion`).
"""

import math
from typing import NamedTuple

from lta_config.constants import AIR_DENSITY, STANDARD_GRAVITY
from lta_config.settings import setting, Settings
from lta_control.allocation import Columns, is_any_motor_turning, NO_ROTORS, PerRotor
from lta_control.bias_calibration import (
    compute_biases,
    is_tilted,
    is_turning,
    reset_unless_still,
    rest_step,
    RestSums,
    SensorBiases,
)
from lta_control.motion import (
    advance_position,
    Quaternion,
    up_in_body,
    Vector,
    yaw_from_quaternion,
)
from lta_control.motion_filters import (
    airspeed_step,
    AirspeedEstimate,
    AltitudeEstimate,
    AltitudeSettings,
    attitude_step,
    correct_altitude,
    HullDragModel,
    predict_altitude,
)
from lta_control.odometry.ground_state import GroundSettings

GYRO_REACH = math.radians(3000.0)  # rad/s; the BMI088 measures 2000 deg/s
HARDEST_PULL = 400.0  # m/s2; it measures 24 g
UPRIGHT_COSINE = 0.1  # cosine of the tilt below which climb and heave are not separated
STUCK = 2.0  # s of turning motors without a new reading, after which a sensor is not believed
REST_PATIENCE = 5.0  # rest times without motion, after which a tilt is accepted and a turn refused


class EstimatorSettings(Settings):
    """Settings of the estimator's filters."""

    rest_time: float = setting(2.0, 's', 0.1, 60.0, fixed=True)
    """Time that the drone must stand still at the start to calibrate the sensor biases."""
    gravity_gain: float = setting(0.1, '1/s', 0.0, 5.0)
    """Gain with which the measured direction of gravity corrects roll and pitch."""
    accelerometer_trust: float = setting(1.0, 's', 0.05, 60.0)
    """Time constant with which the airspeed estimate converges to that of the drag model."""
    air_density: float = setting(AIR_DENSITY, 'kg/m3', 0.5, 2.0)
    """Density of the air, for computing height from air pressure."""
    altitude: AltitudeSettings = setting(AltitudeSettings())
    """Noise settings of the altitude filter."""
    ground: GroundSettings = setting(GroundSettings())
    """Wind and noise that the filter of the motion over ground expects."""


class EstimatorModel(NamedTuple):
    """Vehicle data for the estimator."""

    hull: HullDragModel
    # Height of the hull centre above the floor while the vehicle stands on it [m]
    standing_height: float
    # Sensor positions, body frame [m]
    imu_position: Vector
    range_position: Vector
    number: int  # number of rotors, 1 to 8
    allocation: Columns  # B: one column per slot [N/N, m]
    # Thrust curve T = a u^2 + b u by slot [N]
    a: PerRotor
    b: PerRotor
    # Time constants of the motors [s]
    lag_up: float
    lag_down: float
    # IMU biases in the vehicle file; the calibrated ones are expected near them [rad/s, m/s2]
    rate_bias: Vector = (0.0, 0.0, 0.0)
    force_bias: Vector = (0.0, 0.0, 0.0)


class SensorWatch(NamedTuple):
    """The newest reading of a sensor, and how long motors have turned since it changed [s]."""

    reading: float = 0.0
    age: float = 0.0


class HeightSensors(NamedTuple):
    """The two sensors that measure the height."""

    range: SensorWatch = SensorWatch()
    pressure: SensorWatch = SensorWatch()


class MotionEstimate(NamedTuple):
    """
    Full state of the estimator; before `ready`, only `rest` and the height are valid.

    Until then `biases` are the last rejected ones.
    """

    ready: bool = False  # whether the biases are known
    rest: RestSums = RestSums()
    biases: SensorBiases = SensorBiases()
    attitude: Quaternion = (0.0, 0.0, 0.0, 1.0)
    rates: Vector = (0.0, 0.0, 0.0)
    altitude: AltitudeEstimate = AltitudeEstimate()
    airspeed: AirspeedEstimate = AirspeedEstimate()
    position: tuple[float, float] = (0.0, 0.0)
    duties: PerRotor = NO_ROTORS  # reached by the motors
    flight_time: float = 0.0  # since the calibration ended [s]
    sensors: HeightSensors = HeightSensors()


class EstimatorInputs(NamedTuple):
    """Measurements of one step; NaN where there is none."""

    rates: Vector  # [rad/s]
    force: Vector  # specific force [m/s2]
    range: float  # [m]; infinite where nothing is in range
    pressure: float  # [Pa]
    duties: PerRotor  # the newest command


def mask_out_of_range(reading: float, lowest: float, highest: float) -> float:
    """Return a reading, or NaN outside the sensor's range (REP-117)."""
    return reading if lowest <= reading <= highest else math.nan


def watch_sensor(watch: SensorWatch, reading: float, turning: bool, dt: float) -> SensorWatch:
    """
    Return what is known about a sensor `dt` seconds later.

    Noise changes every reading of a drone in flight, so one that repeats to the bit is no new
    one; neither is NaN or infinity. At rest a sensor may be quiet: time counts while motors are
    `turning`.
    """
    if math.isfinite(reading) and reading != watch.reading:
        return SensorWatch(reading, 0.0)
    return SensorWatch(watch.reading, watch.age + dt if turning else watch.age)


def watch_height_sensors(
    sensors: HeightSensors, distance: float, pressure: float, turning: bool, dt: float
) -> HeightSensors:
    """Return what is known about both sensors after readings [m, Pa]; see `watch_sensor`."""
    return HeightSensors(
        watch_sensor(sensors.range, distance, turning, dt),
        watch_sensor(sensors.pressure, pressure, turning, dt),
    )


def is_stuck(watch: SensorWatch) -> bool:
    """Return whether a sensor has given no new reading for too long."""
    return watch.age > STUCK


def has_height(estimate: MotionEstimate) -> bool:
    """Return whether range finder or barometer still measure the height."""
    return not (is_stuck(estimate.sensors.range) and is_stuck(estimate.sensors.pressure))


def air_relative_velocity(estimate: MotionEstimate) -> Vector:
    """Return the air-relative body velocity that matches the estimated climb rate [m/s]."""
    ux, uy, uz = up_in_body(estimate.attitude)
    surge, sway = estimate.airspeed.surge, estimate.airspeed.sway
    climb = estimate.altitude.climb
    # Solve climb = up . velocity for the heave
    return (
        surge,
        sway,
        (climb - (ux * surge + uy * sway)) / uz if uz > UPRIGHT_COSINE else climb,
    )


def is_plausible_imu_sample(rates: Vector, force: Vector) -> bool:
    """Return whether a sample is physically possible [rad/s, m/s2]; False with a NaN."""
    p, q, r = rates
    x, y, z = force
    # One impossible sample would corrupt the attitude for the rest of the flight
    turning = abs(p) <= GYRO_REACH and abs(q) <= GYRO_REACH and abs(r) <= GYRO_REACH
    pulling = abs(x) <= HARDEST_PULL and abs(y) <= HARDEST_PULL and abs(z) <= HARDEST_PULL
    return turning and pulling


def estimator_step(
    settings: EstimatorSettings,
    body: EstimatorModel,
    state: MotionEstimate,
    inputs: EstimatorInputs,
    dt: float,
) -> MotionEstimate:
    """Return the estimate after one IMU sample and the other measurements of the step."""
    if not state.ready:
        return _calibrate_at_rest(settings, body, state, inputs, dt)
    # Order: attitude first, because removing gravity from the force needs it
    rates = _subtract_vectors(inputs.rates, state.biases.rates)
    force = _subtract_vectors(inputs.force, state.biases.force)
    attitude = attitude_step(state.attitude, rates, force, settings.gravity_gain, dt)
    up = up_in_body(attitude)
    swing = _lever_arm_acceleration(body.imu_position, rates, state.rates, dt)
    moving = _subtract_vectors(
        _subtract_vectors(
            force, (STANDARD_GRAVITY * up[0], STANDARD_GRAVITY * up[1], STANDARD_GRAVITY * up[2])
        ),
        swing,
    )
    turning = is_any_motor_turning(inputs.duties)
    # Beyond 60 degrees of tilt the beam no longer points at the floor
    distance = inputs.range if up[2] > 0.5 else math.nan
    sensors = watch_height_sensors(state.sensors, distance, inputs.pressure, turning, dt)
    # The drag model needs the thrust now, not the commanded one
    duties = _lag_duties(body, state.duties, inputs.duties, dt)
    airspeed = airspeed_step(
        body.hull,
        state.airspeed,
        _rotor_force(body, duties),
        (moving[0], moving[1]),
        rates[2],
        settings.accelerometer_trust,
        dt,
    )
    return MotionEstimate(
        True,
        state.rest,
        state.biases,
        attitude,
        rates,
        _update_altitude(
            settings,
            body,
            state,
            math.nan if is_stuck(sensors.range) else distance,
            math.nan if is_stuck(sensors.pressure) else inputs.pressure,
            up,
            moving,
            dt,
        ),
        airspeed,
        advance_position(
            state.position, airspeed.surge, airspeed.sway, yaw_from_quaternion(attitude), dt
        ),
        duties,
        state.flight_time + dt,
        sensors,
    )


def _calibrate_at_rest(
    settings: EstimatorSettings,
    body: EstimatorModel,
    state: MotionEstimate,
    inputs: EstimatorInputs,
    dt: float,
) -> MotionEstimate:
    """Accumulate means while the drone stands still, until the calibration is complete."""
    rest = rest_step(state.rest, inputs.rates, inputs.force, inputs.pressure)
    rested = rest.samples * dt
    # The landing gear's height is more accurate than a range finder so near to the floor.
    height = body.standing_height
    altitude = correct_altitude(state.altitude, height, settings.altitude.range_noise, False)
    ready, biases = False, state.biases
    if rested >= settings.rest_time and rest.pressures > 0:
        # Checked before it is accepted: a moving or tilted drone must not define the biases
        candidate = compute_biases(rest, height, settings.air_density)
        turns, long = (
            is_turning(candidate, body.rate_bias),
            rested >= REST_PATIENCE * settings.rest_time,
        )
        ready = not turns and (long or not is_tilted(candidate, body.force_bias))
        if ready or long:
            biases = candidate
        # Samples from a turning drone are useless for the rest: start again.
        rest = reset_unless_still(rest, ready or not long)
    return MotionEstimate(
        ready,
        rest,
        biases,
        state.attitude,
        state.rates,
        altitude,
        state.airspeed,
        state.position,
        state.duties,
        state.flight_time,
        state.sensors,
    )


def _subtract_vectors(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _add_vectors(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _lever_arm_acceleration(place: Vector, rates: Vector, before: Vector, dt: float) -> Vector:
    """
    Return the acceleration of the IMU relative to the hull centre: w' x r + w x (w x r). [m/s2].

    Differentiated rates are too noisy as an acceleration, but the filters integrate them back to
    w x r. Without this term, each swing of the gondola would appear as hull speed.
    """
    turning = (
        (rates[0] - before[0]) / dt,
        (rates[1] - before[1]) / dt,
        (rates[2] - before[2]) / dt,
    )
    return _add_vectors(
        _cross_product(turning, place), _cross_product(rates, _cross_product(rates, place))
    )


def _cross_product(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _update_altitude(
    settings: EstimatorSettings,
    body: EstimatorModel,
    state: MotionEstimate,
    distance: float,
    pressure: float,
    up: Vector,
    moving: Vector,
    dt: float,
) -> AltitudeEstimate:
    weights = settings.altitude
    upward = up[0] * moving[0] + up[1] * moving[1] + up[2] * moving[2]
    altitude = predict_altitude(
        state.altitude, upward, weights.acceleration_noise, weights.offset_walk, dt
    )
    if math.isfinite(pressure):
        drop = state.biases.pressure - pressure
        # Hydrostatic equation; the density is constant over the height of a room
        height = drop / (settings.air_density * STANDARD_GRAVITY)
        altitude = correct_altitude(altitude, height, weights.pressure_noise, True)
    if math.isfinite(distance):
        px, py, pz = body.range_position
        # Height of the sensor above the hull centre; the slant range times cos(tilt) is its height
        below = px * up[0] + py * up[1] + pz * up[2]
        altitude = correct_altitude(altitude, distance * up[2] - below, weights.range_noise, False)
    return altitude


def _lag_duties(
    body: EstimatorModel, before: PerRotor, commanded: PerRotor, dt: float
) -> PerRotor:
    """Return the duties reached by the motors, with the nominal lag."""
    up, down = _lag_share(body.lag_up, dt), _lag_share(body.lag_down, dt)
    return (
        _lag_one_duty(before[0], commanded[0], up, down),
        _lag_one_duty(before[1], commanded[1], up, down),
        _lag_one_duty(before[2], commanded[2], up, down),
        _lag_one_duty(before[3], commanded[3], up, down),
        _lag_one_duty(before[4], commanded[4], up, down),
        _lag_one_duty(before[5], commanded[5], up, down),
        _lag_one_duty(before[6], commanded[6], up, down),
        _lag_one_duty(before[7], commanded[7], up, down),
    )


def _lag_share(lag: float, dt: float) -> float:
    """Return the share of the remaining difference that a motor covers in `dt`."""
    return 1.0 - math.exp(-dt / lag) if lag > 0.0 else 1.0


def _lag_one_duty(before: float, commanded: float, up: float, down: float) -> float:
    # Spinning up and coasting down may have different time constants
    share = up if abs(commanded) > abs(before) else down
    return before + share * (commanded - before)


def _rotor_force(body: EstimatorModel, duties: PerRotor) -> tuple[float, float]:
    """Return the rotors' force along body x and y. [N]."""
    fx = fy = 0.0
    for j in range(body.number):
        # T = a u^2 + b u, odd in u
        thrust = (body.a[j] * abs(duties[j]) + body.b[j]) * duties[j]
        fx += body.allocation[j][0] * thrust
        fy += body.allocation[j][1] * thrust
    return fx, fy
