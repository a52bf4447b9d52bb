r"""
Estimate the motion over ground: velocity and position, with a covariance that accounts for wind.

No sensor on board measures a steady wind. What is known of the motion over ground is that the
drone begins at rest, that drag then carries it along with the air, and that a lamp stands still.
A Kalman filter combines them. Its nine states, in the odom frame, are

- the position p;
- the drift d: the velocity over ground, less the airspeed u of the drag model
  (`lta_control.odometry.airspeed`), which begins at rest as the drone does;
- the wind w, a random walk from a prior of zero mean (`GroundSettings.wind`);
- the lamp: bearing :math:`\varphi` and logarithm of the distance :math:`\rho` from the drone, and
  brightness c. Log-polar coordinates keep the filter consistent while the distance is hardly
  known (Aidala and Hammel, Utilization of modified polar coordinates for bearings-only tracking,
  IEEE Trans. Autom. Control 28, 1983).

.. math::

    p' = u + d, \quad d' = k (w - d), \quad \ln S = c - 2 \rho

with k the slope of the drag over the mass: at rest d = 0, and after some seconds of flight
d = w. S is the strength of the lamp's light. Bearings determine the velocity across the line of
sight relative to the distance, strengths that along it. The distance itself follows from the
motion in the first seconds, when the drift is still small. Without a lamp in view, the
covariance grows to that of the prior.

The position is advanced in each step, the covariance every `PERIOD`. Plain Python numbers, so that
all nodes and loops get the same bits.
"""

from collections.abc import Sequence
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from lta_config.settings import setting, Settings
from lta_control.attitude import yaw_from_quaternion
from lta_control.cascade import wrap_angle
from lta_control.odometry.airspeed import HullDragModel
from lta_control.sighting import bearing_deviation, facing_strength, LampPosition

if TYPE_CHECKING:
    from lta_control.estimator import MotionEstimate

Row = tuple[float, ...]  # one number per state
Covariance = tuple[float, float, float]  # xx, xy, yy of a vector in the plane

X, Y, DRIFT_X, DRIFT_Y, WIND_X, WIND_Y, BEARING, LOG_DISTANCE, BRIGHTNESS = range(9)

PERIOD = 0.1  # s between predictions of the covariance
START = 0.01  # m: standard deviation of the origin
SLIP = 0.03  # m in one second: error of the position beyond that of the velocity
DRAG_ERROR = 0.2  # relative error of the drag's slope
TRUSTED = 0.05  # rad: a lamp partly hidden by the hull is reported with a larger deviation
NEAREST = 0.3  # m
ASIDE = 0.1  # m: lamp and diode ring have an extent, which displaces a near lamp
OVER = 1.2  # m: largest difference of height, which adds to the distance of a near lamp
FADING = 0.02  # of the logarithm of the brightness in one second
ASPECT = 1.0  # of ln(brightness) per radian of bearing: the lamp is seen from another side ...
ASPECT_TIME = 5.0  # ... as long as the bearing changes in one direction [s]
GATE = 4.0  # standard deviations beyond which a sighting is an outlier
DOUBT = 1.5  # s of outliers only, after which the lamp is another one
RESTART = 10.0  # m; of the position, where the filter begins again
SEPARATION = 5.0  # Hz: half a bin of the spectrum; lamps differ by more


class GroundSettings(Settings):
    """Prior knowledge of the wind, and the noise of the drag model and of lamp sightings."""

    wind: float = setting(
        0.3,
        'Standard deviation of the wind, along each axis, that is expected before the flight.',
        unit='m/s',
        low=0.0,
        high=20.0,
    )
    gusts: float = setting(
        0.015, 'Expected random change of the wind in one second.', unit='m/s', low=0.0, high=5.0
    )
    thrust_noise: float = setting(
        0.01,
        'Random error, in one second, of the velocity computed from thrust and drag.',
        unit='m/s',
        low=0.0,
        high=5.0,
    )
    bearing_noise: float = setting(
        0.05,
        'Standard deviation added to that of each bearing. It is larger than the error of one '
        'bearing, because the errors of successive bearings are alike.',
        unit='rad',
        low=1e-4,
        high=3.0,
    )
    strength_noise: float = setting(
        0.06,
        'Standard deviation of the logarithm of a measured lamp strength.',
        unit='1',
        low=1e-3,
        high=5.0,
    )


class LampSighting(NamedTuple):
    """
    A lamp as one light block shows it.

    Attributes
    ----------
    bearing, deviation : float
        In the body frame, and its standard deviation. [rad]
    distance, spread : float
        Rough distance [m], and its relative standard deviation.
    strength : float
        Amplitude of a diode that would face the lamp. [ADC counts]
    frequency : float
        Which tells lamps apart. [Hz]
    age : float
        Time since the middle of the block. [s]

    """

    bearing: float
    deviation: float
    distance: float
    spread: float
    strength: float
    frequency: float
    age: float


class ModelledMotion(NamedTuple):
    """
    What the filter takes from the estimator.

    Attributes
    ----------
    ready : bool
        Whether the IMU biases are known.
    yaw, yaw_rate : float
        Heading in the odom frame [rad], and its rate [rad/s].
    surge, sway : float
        Airspeed of the drag model, body frame. [m/s]

    """

    ready: bool
    yaw: float
    yaw_rate: float
    surge: float
    sway: float


NOTHING: Row = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class GroundMotion(NamedTuple):
    """
    State of the filter; `rows` is empty before the first step.

    Attributes
    ----------
    mean, rows
        States in the order of the module's constants, and their covariance.
    air : tuple of float
        Velocity of the drag model. [m/s, odom]
    moved : tuple of float
        Way since the last prediction. [m, odom]
    elapsed : float
        Time since the last prediction. [s]
    frequency : float
        Of the lamp in the state; 0 while there is none. [Hz]
    doubted : float
        Time since the last sighting that fitted, with outliers only. [s]
    restarts : int
        How often the filter began again, because its state could not be computed.

    """

    mean: Row = NOTHING
    rows: tuple[Row, ...] = ()
    air: tuple[float, float] = (0.0, 0.0)
    moved: tuple[float, float] = (0.0, 0.0)
    elapsed: float = 0.0
    frequency: float = 0.0
    doubted: float = 0.0
    restarts: int = 0

    @property
    def position(self) -> tuple[float, float]:
        """Position. [m, odom]"""
        return self.mean[X], self.mean[Y]

    @property
    def position_covariance(self) -> Covariance:
        """Covariance of the position. [m2, odom]"""
        return self.rows[X][X], self.rows[X][Y], self.rows[Y][Y]

    @property
    def velocity(self) -> tuple[float, float]:
        """Velocity over ground. [m/s, odom]"""
        return self.air[0] + self.mean[DRIFT_X], self.air[1] + self.mean[DRIFT_Y]

    @property
    def velocity_covariance(self) -> Covariance:
        """Covariance of the velocity over ground. [m2/s2, odom]"""
        r = self.rows
        return r[DRIFT_X][DRIFT_X], r[DRIFT_X][DRIFT_Y], r[DRIFT_Y][DRIFT_Y]

    @property
    def airspeed(self) -> tuple[float, float]:
        """Velocity through the air. [m/s, odom]"""
        mean, (x, y) = self.mean, self.velocity
        return x - mean[WIND_X], y - mean[WIND_Y]

    @property
    def airspeed_covariance(self) -> Covariance:
        """Covariance of the velocity through the air. [m2/s2, odom]"""
        r = self.rows
        return (
            _slip_variance(r, DRIFT_X, WIND_X),
            r[DRIFT_X][DRIFT_Y] - r[DRIFT_X][WIND_Y] - r[WIND_X][DRIFT_Y] + r[WIND_X][WIND_Y],
            _slip_variance(r, DRIFT_Y, WIND_Y),
        )


def build_sighting(
    lamp: LampPosition | None,
    axes: tuple[tuple[float, float], ...],
    amplitudes: tuple[float, ...],
    frequencies: tuple[float, ...],
    age: float,
) -> LampSighting | None:
    """
    Return the sighting of one block; None where no lamp is seen well.

    `lamp` is its estimate in the body frame; the tuples have one item per diode. `age` is the time
    since the middle of the block [s].
    """
    if lamp is None or not amplitudes or len(frequencies) != len(amplitudes):
        return None
    distance, deviation = math.hypot(lamp.x, lamp.y), bearing_deviation(lamp)
    known = tuple([a if math.isfinite(a) else 0.0 for a in amplitudes])
    strength = facing_strength(axes, known)
    frequency = frequencies[known.index(max(known))]
    # NaN compares false
    if not (deviation <= TRUSTED and distance > NEAREST and strength > 0.0 and frequency > 0.0):
        return None
    xx, xy, yy = lamp.spread
    x, y = lamp.x / distance, lamp.y / distance
    along = max(x * x * xx + 2.0 * x * y * xy + y * y * yy, 0.0)
    return LampSighting(
        math.atan2(lamp.y, lamp.x),
        deviation,
        distance,
        math.sqrt(along) / distance,
        strength,
        frequency,
        age,
    )


def read_modelled_motion(estimate: 'MotionEstimate') -> ModelledMotion:
    """Return what the filter takes from the estimator's state."""
    speed, yaw = estimate.airspeed, yaw_from_quaternion(estimate.attitude)
    return ModelledMotion(
        estimate.ready, yaw, estimate.rates[2], speed.model_surge, speed.model_sway
    )


def ground_step(
    settings: GroundSettings,
    hull: HullDragModel,
    state: GroundMotion,
    motion: ModelledMotion,
    sighting: LampSighting | None,
    dt: float,
) -> GroundMotion:
    """Return the motion over ground one step later, from the newest modelled motion."""
    if not state.rows:
        state = start_ground_motion(settings)
    ready, yaw, yaw_rate, surge, sway = motion
    cos, sin = math.cos(yaw), math.sin(yaw)
    air = cos * surge - sin * sway, sin * surge + cos * sway
    mean, moved = state.mean, state.moved
    way = dt * (air[0] + mean[DRIFT_X]), dt * (air[1] + mean[DRIFT_Y])
    # The frame begins where the drone stands when the estimate is ready
    place = (mean[X] + way[0], mean[Y] + way[1]) if ready else (0.0, 0.0)
    state = GroundMotion(
        (*place, *mean[DRIFT_X:]),
        state.rows,
        air,
        (moved[0] + way[0], moved[1] + way[1]),
        state.elapsed + dt,
        state.frequency,
        state.doubted,
        state.restarts,
    )
    if not ready:
        sighting = None
    if sighting is None and state.elapsed < PERIOD - 0.5 * dt:
        return state
    # A bearing holds for the middle of its block
    bearing = 0.0 if sighting is None else yaw - yaw_rate * sighting.age + sighting.bearing
    try:
        after = _predict(settings, hull, state, (cos, sin))
        if sighting is not None:
            after = _correct(settings, after, sighting, bearing, state.doubted + state.elapsed)
    except (OverflowError, ZeroDivisionError, ValueError):
        # Sightings that contradict each other: the drone flies on without
        return _restart(settings, state)
    return after if _is_computable(after) else _restart(settings, state)


def _is_computable(state: GroundMotion) -> bool:
    """Return whether all numbers are finite and all variances positive."""
    variances = [row[i] for i, row in enumerate(state.rows)]
    return math.isfinite(sum(map(sum, state.rows)) + sum(state.mean)) and min(variances) >= 0.0


def _restart(settings: GroundSettings, state: GroundMotion) -> GroundMotion:
    """Return a state that keeps the position, and knows of the motion no more than the prior."""
    place = [each if math.isfinite(each) else 0.0 for each in state.position]
    fresh = start_ground_motion(settings)
    lost, wind = RESTART * RESTART, fresh.rows[WIND_X][WIND_X]
    variances = (lost, lost, wind, wind, wind, wind, 0.0, 0.0, 0.0)
    air = state.air if all(map(math.isfinite, state.air)) else (0.0, 0.0)
    return fresh._replace(
        mean=(*place, *NOTHING[DRIFT_X:]),
        rows=tuple([_scale_unit_row(i, variances[i]) for i in range(len(variances))]),
        air=air,
        restarts=state.restarts + 1,
    )


def start_ground_motion(settings: GroundSettings) -> GroundMotion:
    """Return the state at rest at the origin, in an unknown wind."""
    wind = settings.wind * settings.wind
    variances = (START * START, START * START, 0.0, 0.0, wind, wind, 0.0, 0.0, 0.0)
    return GroundMotion(
        rows=tuple([_scale_unit_row(i, variances[i]) for i in range(len(variances))])
    )


def _scale_unit_row(index: int, value: float) -> Row:
    row = [0.0] * len(NOTHING)
    row[index] = value
    return tuple(row)


def _predict(
    settings: GroundSettings,
    hull: HullDragModel,
    state: GroundMotion,
    nose: tuple[float, float],
) -> GroundMotion:
    """Return the state after the way since the last prediction; `nose` is a unit vector."""
    mean, rows, dt = state.mean, state.rows, state.elapsed
    slip = mean[DRIFT_X] - mean[WIND_X], mean[DRIFT_Y] - mean[WIND_Y]
    # Variance of the slip of the true airspeed against the modelled one, over both axes
    spread = _slip_variance(rows, DRIFT_X, WIND_X) + _slip_variance(rows, DRIFT_Y, WIND_Y)
    error = slip[0] * slip[0] + slip[1] * slip[1] + spread
    # Quadratic drag D: D(u + e) - D(u) is about q (|u| + |u + e|) e
    fast = math.hypot(*state.air) + math.sqrt(
        (state.air[0] + slip[0]) ** 2 + (state.air[1] + slip[1]) ** 2 + spread
    )
    ahead = (hull.linear[0] + hull.quadratic[0] * fast) / hull.mass[0]
    aside = (hull.linear[1] + hull.quadratic[1] * fast) / hull.mass[1]
    cos, sin = nose
    kxx, kxy = cos * cos * ahead + sin * sin * aside, cos * sin * (ahead - aside)
    kyy = sin * sin * ahead + cos * cos * aside
    seen = state.frequency > 0.0
    range_rate = turn_rate = to_x = to_y = 0.0
    if seen:
        away = math.exp(mean[LOG_DISTANCE])
        to_x, to_y = math.cos(mean[BEARING]) / away, math.sin(mean[BEARING]) / away
        range_rate = (state.moved[0] * to_x + state.moved[1] * to_y) / dt
        turn_rate = (state.moved[1] * to_x - state.moved[0] * to_y) / dt

    transition = _Transition(
        dt,
        (dt * kxx, dt * kxy, dt * kyy),
        (1.0 + dt * range_rate, dt * turn_rate),
        (dt * to_x, dt * to_y),
    )
    # F P F^T, by rows and then by columns
    half = _transform_rows(transition, rows)
    after = [list(row) for row in _transform_rows(transition, tuple(zip(*half, strict=True)))]
    model = settings.thrust_noise**2 + 2.0 * (DRAG_ERROR * 0.5 * (ahead + aside)) ** 2 * error
    gusts = settings.gusts * settings.gusts
    noise = (SLIP * SLIP, SLIP * SLIP, model, model, gusts, gusts, 0.0, 0.0, 0.0)
    for i, density in enumerate(noise):
        after[i][i] += dt * density
    if seen:
        after[8][8] += dt * (FADING * FADING + 2.0 * ASPECT_TIME * (ASPECT * turn_rate) ** 2)
    lamp = mean[BEARING], mean[LOG_DISTANCE]
    if seen:
        away = math.exp(mean[LOG_DISTANCE])
        x = away * math.cos(mean[BEARING]) - state.moved[0]
        y = away * math.sin(mean[BEARING]) - state.moved[1]
        lamp = math.atan2(y, x), math.log(max(math.hypot(x, y), NEAREST))
    return state._replace(
        mean=(
            mean[X],
            mean[Y],
            mean[DRIFT_X] - dt * (kxx * slip[0] + kxy * slip[1]),
            mean[DRIFT_Y] - dt * (kxy * slip[0] + kyy * slip[1]),
            mean[WIND_X],
            mean[WIND_Y],
            *lamp,
            mean[BRIGHTNESS],
        ),
        rows=tuple([tuple(row) for row in after]),
        moved=(0.0, 0.0),
        elapsed=0.0,
    )


class _Transition(NamedTuple):
    """What makes up the derivative of the states after a time by those before."""

    dt: float
    pull: Covariance  # of the drag, kxx, kxy and kyy
    lamp: tuple[float, float]  # of bearing and log-distance: by themselves, and by each other
    toward: tuple[float, float]  # unit vector to the lamp over the distance; zero without one


def _transform_rows(f: _Transition, rows: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return F times a matrix."""
    r0, r1, r2, r3, r4, r5, r6, r7, r8 = rows
    dt, (kxx, kxy, kyy), (same, turn), (x, y) = f
    return (
        [a + dt * b for a, b in zip(r0, r2, strict=True)],
        [a + dt * b for a, b in zip(r1, r3, strict=True)],
        [a - kxx * (a - c) - kxy * (b - d) for a, b, c, d in zip(r2, r3, r4, r5, strict=True)],
        [b - kxy * (a - c) - kyy * (b - d) for a, b, c, d in zip(r2, r3, r4, r5, strict=True)],
        r4,
        r5,
        [same * p + turn * q + y * a - x * b for p, q, a, b in zip(r6, r7, r2, r3, strict=True)],
        [same * q - turn * p - x * a - y * b for p, q, a, b in zip(r6, r7, r2, r3, strict=True)],
        r8,
    )


def rotate_covariance(covariance: Covariance, angle: float) -> Covariance:
    """Return a covariance in axes that are turned by an angle. [rad]"""
    (xx, xy, yy), cos, sin = covariance, math.cos(angle), math.sin(angle)
    return (
        cos * cos * xx + 2.0 * cos * sin * xy + sin * sin * yy,
        (cos * cos - sin * sin) * xy + cos * sin * (yy - xx),
        sin * sin * xx - 2.0 * cos * sin * xy + cos * cos * yy,
    )


def _slip_variance(rows: tuple[Row, ...], drift: int, wind: int) -> float:
    """Return the variance of a drift less a wind. [m2/s2]"""
    return max(rows[drift][drift] + rows[wind][wind] - 2.0 * rows[drift][wind], 0.0)


def _correct(
    settings: GroundSettings,
    state: GroundMotion,
    sighting: LampSighting,
    bearing: float,
    doubted: float,
) -> GroundMotion:
    """Return the state after a sighting with a bearing in the odom frame. [rad]"""
    same = abs(sighting.frequency - state.frequency) < SEPARATION
    if not same:
        return _restart_lamp(settings, state, sighting, bearing)
    mean, rows = state.mean, state.rows
    square = math.exp(2.0 * mean[LOG_DISTANCE])
    bearing_noise = sighting.deviation**2 + settings.bearing_noise**2 + ASIDE * ASIDE / square
    strength_noise = settings.strength_noise**2 + (OVER * OVER / square) ** 2
    turn = wrap_angle(bearing - mean[BEARING])
    gap = math.log(sighting.strength) - _expect_log_strength(mean)
    turn_size = rows[BEARING][BEARING] + bearing_noise
    gap_size = _measure_strength(rows)[1] + strength_noise
    if turn * turn > GATE * GATE * turn_size or gap * gap > GATE * GATE * gap_size:
        if doubted > DOUBT:
            return _restart_lamp(settings, state, sighting, bearing)
        return state._replace(doubted=doubted)
    # The measured state is the bearing itself, so P H^T is its row
    mean, rows = _update(mean, rows, rows[BEARING], turn / turn_size, turn_size)
    gains, size = _measure_strength(rows)
    gap = math.log(sighting.strength) - _expect_log_strength(mean)
    size += strength_noise
    mean, rows = _update(mean, rows, gains, gap / size, size)
    return state._replace(mean=mean, rows=rows, doubted=0.0)


def _expect_log_strength(mean: Row) -> float:
    return mean[BRIGHTNESS] - 2.0 * mean[LOG_DISTANCE]


def _measure_strength(rows: tuple[Row, ...]) -> tuple[list[float], float]:
    """Return P H^T of the logarithm of the strength, and its variance without noise."""
    gains = [b - 2.0 * a for a, b in zip(rows[LOG_DISTANCE], rows[BRIGHTNESS], strict=True)]
    return gains, gains[BRIGHTNESS] - 2.0 * gains[LOG_DISTANCE]


def _update(
    mean: Row, rows: tuple[Row, ...], gains: Sequence[float], step: float, size: float
) -> tuple[Row, tuple[Row, ...]]:
    """Return mean and covariance after a measurement; `step` is the innovation over its `size`."""
    scaled = [g / size for g in gains]
    after = [
        tuple([p - g * h for p, h in zip(row, scaled, strict=True)])
        for row, g in zip(rows, gains, strict=True)
    ]
    return tuple([m + step * g for m, g in zip(mean, gains, strict=True)]), tuple(after)


def _restart_lamp(
    settings: GroundSettings, state: GroundMotion, sighting: LampSighting, bearing: float
) -> GroundMotion:
    """Return the state with a lamp of which nothing but this sighting is known."""
    distance = math.log(sighting.distance)
    lamp = bearing, distance, math.log(sighting.strength) + 2.0 * distance
    variance = sighting.spread * sighting.spread
    turn = sighting.deviation**2 + settings.bearing_noise**2
    rows = [(*row[:BEARING], 0.0, 0.0, 0.0) for row in state.rows[:BEARING]]
    # A brighter lamp is farther away
    rows += [
        _scale_unit_row(BEARING, turn),
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, variance, 2.0 * variance),
        (
            0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            2.0 * variance, 4.0 * variance + settings.strength_noise**2,
        ),
    ]  # fmt: skip
    return state._replace(
        mean=(*state.mean[:BEARING], *lamp),
        rows=tuple(rows),
        frequency=sighting.frequency,
        doubted=0.0,
    )
