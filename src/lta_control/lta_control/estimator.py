"""
The drone's own idea of its motion, from its sensors and commands only.

At rest on level ground it first learns the biases of the IMU and the pressure of the floor
(`rest_time`), and anew where it is moved meanwhile. Where the biases are more than the sensor's,
it waits for others. A tilt is taken in the end, since a drone out of balance stands tilted; a turn
never is, since what turns does not rest, and would turn in its own eyes ever after. Then attitude,
altitude and airspeed are filtered step by step. Position is dead reckoning through the air and
says so by its covariance.
"""

import math
from typing import NamedTuple

from lta_config.constants import AIR_DENSITY, STANDARD_GRAVITY
from lta_config.settings import setting, Settings
from lta_control.airspeed import airspeed_step, AirspeedEstimate, HullDragModel
from lta_control.allocation import Columns
from lta_control.altitude import (
    AltitudeEstimate,
    AltitudeSettings,
    correct_altitude,
    predict_altitude,
)
from lta_control.attitude import attitude_step, Quaternion, up_in_body, Vector, yaw_from_quaternion
from lta_control.bias_calibration import (
    compute_biases,
    is_tilted,
    is_turning,
    reset_unless_still,
    rest_step,
    RestSums,
    SensorBiases,
)
from lta_control.per_rotor import NONE, PerRotor

PATIENCE = 5.0  # rest times unmoved, after which a tilt is taken, and a turn refused


class EstimatorSettings(Settings):
    """How the filters weigh what they hear."""

    rest_time: float = setting(
        2.0, 'Time at rest for learning the biases.', unit='s', low=0.1, high=60.0, fixed=True
    )
    gravity_gain: float = setting(
        0.1, 'How fast gravity corrects roll and pitch.', unit='1/s', low=0.0, high=5.0
    )
    accelerometer_trust: float = setting(
        1.0,
        'Time over which integrated acceleration is believed against the drag model.',
        unit='s',
        low=0.05,
        high=60.0,
    )
    air_density: float = setting(
        AIR_DENSITY,
        'Density of the air, for the pressure height.',
        unit='kg/m3',
        low=0.5,
        high=2.0,
    )
    altitude: AltitudeSettings = setting(AltitudeSettings(), 'The altitude filter.')


class EstimatorModel(NamedTuple):
    """
    What the estimator knows of the vehicle.

    Attributes
    ----------
    hull : Hull
        The drag model.
    standing_height : float
        Of the hull centre above the floor while the vehicle stands on it. [m]
    imu_position, range_position : tuple
        Where the sensors sit, body frame. [m]
    number : int
        Rotors, 1 to 8.
    allocation : tuple of tuple of float
        B: one column a slot. [N/N, m]
    a, b : tuple of float
        Thrust curve T = a u^2 + b u by slot. [N]
    lag_up, lag_down : float
        Time constants of the motors. [s]
    rate_bias, force_bias : tuple
        Biases of the IMU that are told of it: what is learned lies about them. [rad/s, m/s2]

    """

    hull: HullDragModel
    standing_height: float
    imu_position: Vector
    range_position: Vector
    number: int
    allocation: Columns
    a: PerRotor
    b: PerRotor
    lag_up: float
    lag_down: float
    rate_bias: Vector = (0.0, 0.0, 0.0)
    force_bias: Vector = (0.0, 0.0, 0.0)


class MotionEstimate(NamedTuple):
    """
    Everything the estimator remembers; nothing but `rest` and the height until it is ready.

    Until then `biases` are the last ones that were refused.
    """

    ready: bool = False  # whether the biases are known
    rest: RestSums = RestSums()
    biases: SensorBiases = SensorBiases()
    attitude: Quaternion = (0.0, 0.0, 0.0, 1.0)
    rates: Vector = (0.0, 0.0, 0.0)
    altitude: AltitudeEstimate = AltitudeEstimate()
    airspeed: AirspeedEstimate = AirspeedEstimate()
    position: tuple[float, float] = (0.0, 0.0)
    duties: PerRotor = NONE  # that the motors have reached
    flown: float = 0.0  # time since the rest ended [s]


class EstimatorInputs(NamedTuple):
    """One step's measurements; NaN where nothing has come."""

    rates: Vector  # [rad/s]
    force: Vector  # specific force [m/s2]
    range: float  # [m]; infinite where nothing is in reach
    pressure: float  # [Pa]
    duties: PerRotor  # the newest command


def estimator_step(
    settings: EstimatorSettings,
    body: EstimatorModel,
    state: MotionEstimate,
    inputs: EstimatorInputs,
    dt: float,
) -> MotionEstimate:
    """Return the estimate after one IMU sample and whatever else has come with it."""
    if not state.ready:
        return _calibrate_at_rest(settings, body, state, inputs, dt)
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
        _update_altitude(settings, body, state, inputs, up, moving, dt),
        airspeed,
        _advance_position(state.position, airspeed, yaw_from_quaternion(attitude), dt),
        duties,
        state.flown + dt,
    )


def _calibrate_at_rest(
    settings: EstimatorSettings,
    body: EstimatorModel,
    state: MotionEstimate,
    inputs: EstimatorInputs,
    dt: float,
) -> MotionEstimate:
    """Gather means while the drone stands still, until the rest is over."""
    rest = rest_step(state.rest, inputs.rates, inputs.force, inputs.pressure)
    rested = rest.samples * dt
    # The gear's height is known better than a range finder this near to the floor tells it.
    height = body.standing_height
    altitude = correct_altitude(state.altitude, height, settings.altitude.range_noise, False)
    ready, biases = False, state.biases
    if rested >= settings.rest_time and rest.pressures > 0:
        found = compute_biases(rest, height, settings.air_density)
        turns, long = is_turning(found, body.rate_bias), rested >= PATIENCE * settings.rest_time
        ready = not turns and (long or not is_tilted(found, body.force_bias))
        if ready or long:
            biases = found
        # What has turned until now says nothing of when it stands.
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
        state.flown,
    )


def _subtract_vectors(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _add_vectors(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _lever_arm_acceleration(place: Vector, rates: Vector, before: Vector, dt: float) -> Vector:
    """
    Return what the IMU feels beyond the hull centre: w' x r + w x (w x r). [m/s2].

    The difference of noisy rates is no good acceleration, but the filters integrate it, and its
    sum is w x r again. Without it, every swing of the gondola reads as speed of the hull.
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
    inputs: EstimatorInputs,
    up: Vector,
    moving: Vector,
    dt: float,
) -> AltitudeEstimate:
    weights = settings.altitude
    upward = up[0] * moving[0] + up[1] * moving[1] + up[2] * moving[2]
    altitude = predict_altitude(
        state.altitude, upward, weights.acceleration_noise, weights.offset_walk, dt
    )
    if math.isfinite(inputs.pressure):
        drop = state.biases.pressure - inputs.pressure
        height = drop / (settings.air_density * STANDARD_GRAVITY)
        altitude = correct_altitude(altitude, height, weights.pressure_noise, True)
    if math.isfinite(inputs.range) and up[2] > 0.5:
        px, py, pz = body.range_position
        below = px * up[0] + py * up[1] + pz * up[2]
        altitude = correct_altitude(
            altitude, inputs.range * up[2] - below, weights.range_noise, False
        )
    return altitude


def _lag_duties(
    body: EstimatorModel, before: PerRotor, commanded: PerRotor, dt: float
) -> PerRotor:
    """Return the duties that the motors have reached, by the nominal lag."""
    up, down = _lag_share(body.lag_up, dt), _lag_share(body.lag_down, dt)
    return (
        _follow_command(before[0], commanded[0], up, down),
        _follow_command(before[1], commanded[1], up, down),
        _follow_command(before[2], commanded[2], up, down),
        _follow_command(before[3], commanded[3], up, down),
        _follow_command(before[4], commanded[4], up, down),
        _follow_command(before[5], commanded[5], up, down),
        _follow_command(before[6], commanded[6], up, down),
        _follow_command(before[7], commanded[7], up, down),
    )


def _lag_share(lag: float, dt: float) -> float:
    """Return the share of a step that a motor takes in a time."""
    return 1.0 - math.exp(-dt / lag) if lag > 0.0 else 1.0


def _follow_command(before: float, commanded: float, up: float, down: float) -> float:
    share = up if abs(commanded) > abs(before) else down
    return before + share * (commanded - before)


def _rotor_force(body: EstimatorModel, duties: PerRotor) -> tuple[float, float]:
    """Return the rotors' force along body x and y. [N]."""
    fx = fy = 0.0
    for j in range(body.number):
        thrust = (body.a[j] * abs(duties[j]) + body.b[j]) * duties[j]
        fx += body.allocation[j][0] * thrust
        fy += body.allocation[j][1] * thrust
    return fx, fy


def _advance_position(
    position: tuple[float, float], speed: AirspeedEstimate, yaw: float, dt: float
) -> tuple[float, float]:
    cos, sin = math.cos(yaw), math.sin(yaw)
    return (
        position[0] + dt * (cos * speed.surge - sin * speed.sway),
        position[1] + dt * (sin * speed.surge + cos * speed.sway),
    )
