# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Score how well readings of a motion agree with each other: rates, velocities, gravity, course.

Rates are the derivative of an attitude and a velocity that of a place; an accelerometer feels
gravity and what the place accelerates by; an airship moves where it points.
"""

from collections.abc import Iterator
from itertools import permutations, product
from typing import Final, final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_data.even_grid import hann_kernel, smooth_columns
from lta_data.importers.protocol import Numbers
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

KERNEL: Final = 0.25  # that smooths both sides of a comparison [s]
DELAY_COUNT: Final = 7  # that are tried
FILTER_DELAY: Final = 0.3  # that a derived velocity is late: labs filter it [s]
SPEED_ROWS: Final = 9  # rows over which a speed is averaged
# Of a score, that FRD instead of FLU must gain; other axes half as much again
UNUSUAL_AXES_COST: Final = 0.1
AGREEING_SHARE: Final = 0.6  # explained share of a motion that counts as agreement
# All signed orders of three axes, as matrices; first none, mirrored ones included
SIGNED_AXES: Final = tuple(sorted(
    (
        np.diag(signs)[list(order)]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    ),
    key=lambda axes: -np.trace(axes),
))  # fmt: skip
# Those in which a sensor can be turned against a body
SENSOR_AXES: Final = tuple(axes for axes in SIGNED_AXES if np.linalg.det(axes) > 0.0)
FLIP: Final = np.diag([1.0, -1.0, -1.0])  # FRD instead of FLU
ALL_AXES: Final = slice(None)
INSTEAD_OF_ZERO: Final = 1e-300  # instead of zero


@final
class MotionEvidence(NamedTuple):
    """Quantities of one table on its times, shape (n, 3) each; None where they are missing."""

    seconds: Numbers
    position: Numbers | None
    velocity: Numbers | None
    rates: Numbers | None
    acceleration: Numbers | None
    # Of an inertial sensor, whose axes may be others than those of the attitude
    sensed: Numbers | None = None


@final
class ScaleFit(NamedTuple):
    """
    Least-squares factor of a measured on a derived vector, and the share it explains.

    `axes` is the mean share of the single axes, so that a turning vehicle's yaw does not hide the
    sign of its pitch; `worst` is the least of them.
    """

    factor: float
    share: float
    axes: float = 0.0
    worst: float = 0.0

    @property
    def score(self) -> float:
        """How well both agree, from -1 to 1."""
        return 0.5 * (self.share + self.axes)

    @property
    def cosine(self) -> float:
        """Cosine between both, over all samples; 1 for the same motion."""
        return float(np.copysign(np.sqrt(abs(self.share)), self.share))

    @property
    def ratio(self) -> float:
        """Size of the measured vector over that of the derived one."""
        return self.factor * abs(self.cosine)


# Units of what a log states, by how many of them are one of SI
UNIT_FACTORS: Final[dict[str, dict[str, float]]] = {
    'rates': {'rad/s': 1.0, 'deg/s': 180.0 / np.pi, 'mrad/s': 1e3, 'mdeg/s': 180e3 / np.pi},
    'velocity': {'m/s': 1.0, 'mm/s': 1e3, 'cm/s': 100.0, 'km/h': 3.6},
    'force': {
        'm/s2': 1.0, 'g': 1.0 / STANDARD_GRAVITY, 'mg': 1e3 / STANDARD_GRAVITY, 'mm/s2': 1e3,
    },
}  # fmt: skip


def find_gravity_unit(felt: float, tolerance: float = 0.3) -> str:
    """Return the unit in which a usual length of a specific force is gravity; '' if in none."""
    # 30 %: a slow airship accelerates little compared with gravity
    for unit, factor in UNIT_FACTORS['force'].items():
        if abs(felt / (STANDARD_GRAVITY * factor) - 1.0) < tolerance:
            return unit
    return ''


NO_FIT: Final = ScaleFit(float('nan'), 0.0)
FACTOR_LOG_TOLERANCE: Final = 0.3  # tolerance of a factor, as a logarithm


def is_near(factor: float, other: float) -> bool:
    """Return whether two factors are alike: positive, and within 35 % of each other."""
    return factor > 0.0 and abs(np.log(factor / other)) < FACTOR_LOG_TOLERANCE


@final
class VectorMoments(NamedTuple):
    """Sums over the rows of two vectors: of their products, and of their squares."""

    products: Numbers  # derived by measured, shape (3, 3)
    measured: Numbers
    derived: Numbers
    rows: int

    def fit(self, axes: Numbers) -> ScaleFit:
        """Fit the measured vector, turned by `axes`, to the derived one."""
        return self.fit_orders(axes[None])[0]

    def fit_orders(
        self, orders: Numbers, moving: NDArray[np.bool_] | slice = ALL_AXES
    ) -> list[ScaleFit]:
        """Fit the measured vector, turned by each of `orders`, shape (m, 3, 3)."""
        turned, derived = (np.abs(orders) @ self.measured)[:, moving], self.derived[moving]
        total, power = turned.sum(axis=1), derived.sum()
        alike = (self.products * orders).sum(axis=2)[:, moving]
        whole = alike.sum(axis=1)
        # The squared cosine between both, with its sign
        share = whole * np.abs(whole) / np.maximum(power * total, INSTEAD_OF_ZERO)
        singles = alike * np.abs(alike) / np.maximum(turned * derived, INSTEAD_OF_ZERO)
        factor = total / np.maximum(np.abs(whole), INSTEAD_OF_ZERO)
        rows = zip(factor, share, singles.mean(axis=1), singles.min(axis=1), strict=True)
        return [ScaleFit(*map(float, row)) if row[1] else NO_FIT for row in rows]


def fit_scale(
    measured: Numbers, derived: Numbers, seconds: Numbers, latest: float = 0.0
) -> ScaleFit:
    """
    Fit a factor of a measured on a derived vector after smoothing both; means are kept.

    `latest`: the measured vector may be as late as this, by a filter. [s]
    """
    axes = np.eye(measured.shape[1])
    fits = [one.fit(axes) for one in iterate_moments(measured, derived, seconds, latest)]
    return max(fits, key=lambda fit: fit.share, default=NO_FIT)


def find_sensor_axes(
    rates: Numbers, turn: Rotation, seconds: Numbers
) -> tuple[NDArray[np.float64], ScaleFit]:
    """
    Return the matrix from the axes of a sensor of rates to those of an attitude, and the fit.

    Other axes than those of the attitude must explain clearly more.
    """
    count = min(len(seconds), len(turn), len(rates))
    derived = body_rates_of(turn[:count], seconds[:count])
    fits = [
        way
        for one in iterate_moments(rates[:count], derived, seconds[:count], FILTER_DELAY)
        for way in zip(SENSOR_AXES, one.fit_orders(np.array(SENSOR_AXES)), strict=True)
    ]
    if not fits:
        return np.eye(3), NO_FIT
    return max(fits, key=lambda fit: fit[1].score - weigh_axes(fit[0]))


def weigh_axes(axes: Numbers) -> float:
    """Return what axes of a sensor must gain of a score: those of most are those of the body."""
    if axes is SENSOR_AXES[0]:
        return 0.0
    return UNUSUAL_AXES_COST * (1.0 if (axes == FLIP).all() else 1.5)


def iterate_moments(
    measured: Numbers,
    derived: Numbers,
    seconds: Numbers,
    latest: float,
    earliest: float = 0.0,
) -> Iterator[VectorMoments]:
    """Yield the moments of two vectors for each delay of the measured one, from `earliest` [s]."""
    step = float(np.median(np.diff(seconds))) if len(seconds) > 1 else 0.0
    good: NDArray[np.bool_] = np.asarray(
        np.isfinite(measured).all(axis=1) & np.isfinite(derived).all(axis=1)
    )
    if not step > 0.0 or good.sum() < 20:
        return
    weights = hann_kernel(KERNEL, step)
    left, right = (_smooth_finite(side, good, weights) for side in (measured, derived))
    first, last = (min(round(one / step), int(good.sum()) // 2) for one in (-earliest, latest))
    delays = np.concatenate(
        [-np.linspace(0, first, DELAY_COUNT), np.linspace(0, last, DELAY_COUNT)]
    )
    for late in sorted({int(delay) for delay in delays}, key=abs):
        of_left, of_right = (
            slice(max(0, late), len(good) + min(0, late)),
            slice(max(0, -late), len(good) - max(0, late)),
        )
        both = good[of_left] & good[of_right]
        one, other = left[of_left][both], right[of_right][both]
        yield VectorMoments(other.T @ one, (one**2).sum(0), (other**2).sum(0), len(one))


def _smooth_finite(side: Numbers, good: NDArray[np.bool_], weights: Numbers) -> Numbers:
    """Smooth a vector, and clip the glitches of a tracker, which would decide a fit."""
    smooth = smooth_columns(np.where(good.reshape(-1, 1), side, 0.0), weights)
    end = np.percentile(np.abs(smooth[good]), 99.0, axis=0)
    return np.clip(smooth, -end, end)


def differentiate(values: Numbers, seconds: Numbers) -> Numbers:
    """Return the derivative at the samples."""
    rising = np.concatenate(([True], np.diff(seconds) > 0.0))
    rates = np.full(values.shape, np.nan)
    if rising.sum() > 2:
        rates[rising] = np.gradient(values[rising], seconds[rising], axis=0)
    return rates


def body_rates_of(turn: Rotation, seconds: Numbers) -> Numbers:
    """Return the body rates of an attitude, shape (n, 3) [rad/s]."""
    step = np.diff(seconds)
    step = np.where(step > 0.0, step, np.nan)
    rates = (turn[:-1].inv() * turn[1:]).as_rotvec() / step[:, None]
    return np.concatenate([rates, rates[-1:]])


def score_attitude(turn: Rotation, evidence: MotionEvidence) -> tuple[float, list[str]]:
    """Return how well an attitude agrees with the other quantities, and the reasons."""
    scores, reasons = [], []
    seconds = evidence.seconds
    if evidence.rates is not None:
        fit = fit_scale(evidence.rates, body_rates_of(turn, seconds), seconds, FILTER_DELAY)
        scores.append(_score_rates(fit))
        reasons.append(f'the rates follow from it by {100 * max(0.0, fit.share):.0f} %')
    if evidence.velocity is not None and evidence.position is not None:
        speed = differentiate(evidence.position, seconds)
        derived = turn.inv().apply(np.nan_to_num(speed))
        body = fit_scale(evidence.velocity, derived, seconds, FILTER_DELAY)
        world = fit_scale(evidence.velocity, speed, seconds, FILTER_DELAY)
        # Of a velocity in world axes, the same for all readings
        scores.append(max(body.score, world.score))
        if body.share > world.share:
            reasons.append(f'the body velocity by {100 * body.share:.0f} %')
    if evidence.sensed is not None:
        axes, fit = find_sensor_axes(evidence.sensed, turn, seconds)
        scores.append(_score_rates(fit) - weigh_axes(axes))
        reasons.append(f'the rates of the IMU follow from it by {100 * max(0.0, fit.share):.0f} %')
    if evidence.acceleration is not None:
        tried = [axes] if evidence.sensed is not None else [SENSOR_AXES[0], FLIP]
        felt = [_score_gravity(turn, evidence, one) for one in tried]
        felt = [
            (score - weigh_axes(one), why) for (score, why), one in zip(felt, tried, strict=True)
        ]
        scores.append(max(felt)[0])
        reasons.append(max(felt)[1])
    return (float(np.mean(scores)) if scores else 0.0), reasons


def _score_rates(fit: ScaleFit) -> float:
    # A factor of 57.3 is a unit of the rates, or of the angles
    right = any(abs(np.log(fit.factor / one)) < 0.25 for one in (1.0, 57.3)) if (
        fit.share > 0.0) else False  # fmt: skip
    return fit.score if right else 0.5 * fit.score


def _score_gravity(turn: Rotation, evidence: MotionEvidence, axes: Numbers) -> tuple[float, str]:
    """Return the score of an attitude by an accelerometer with these axes, and the reason."""
    assert evidence.acceleration is not None
    felt = evidence.acceleration @ axes.T
    pull = turn.apply(np.nan_to_num(felt))
    share = float(np.linalg.norm(pull.mean(axis=0)) / (np.linalg.norm(pull, axis=1).mean() or 1.0))
    tilt = _explain_tilt(turn, felt, pull.mean(axis=0), evidence)
    why = f'gravity keeps its direction by {100 * share:.0f} %'
    return (share if tilt is None else 0.5 * (share + tilt)), why


def _explain_tilt(
    turn: Rotation, felt: Numbers, gravity: Numbers, evidence: MotionEvidence
) -> float | None:
    """
    Return the share of what an accelerometer feels beside its mean that the attitude explains.

    It feels gravity where the vehicle tilts, and what the position accelerates by, in any unit.
    None without a position: a rotorcraft that tilts feels nothing aside.
    """
    step = float(np.median(np.diff(evidence.seconds))) if len(evidence.seconds) > 1 else 0.0
    if evidence.position is None or not step > 0.0:
        return None
    finite = np.isfinite(np.hstack([evidence.position, felt]))
    good: NDArray[np.bool_] = np.asarray(finite.all(axis=1))
    if good.sum() < 20:
        return None
    weights = hann_kernel(KERNEL, step)
    place = smooth_columns(np.where(good[:, None], evidence.position, 0.0), weights)
    pull = differentiate(differentiate(place, evidence.seconds), evidence.seconds)
    sides = (felt, turn.inv().apply(np.tile(gravity, (len(felt), 1))),
             turn.inv().apply(np.nan_to_num(pull)))  # fmt: skip
    rows = np.flatnonzero(good)
    measured, tilted, moved = (
        (smooth := _smooth_finite(side, good, weights)[rows]) - smooth.mean(axis=0)
        for side in sides
    )
    # The unit of the position is not known yet
    power = float((moved * moved).sum())
    scale = max(0.0, float(((measured - tilted) * moved).sum()) / power) if power > 0.0 else 0.0
    left = ((measured - tilted - scale * moved) ** 2).sum(axis=0)
    total = np.maximum((measured**2).sum(axis=0), INSTEAD_OF_ZERO)
    return float(np.mean(np.clip(1.0 - left / total, -1.0, 1.0)))


def smooth_acceleration(position: Numbers, seconds: Numbers) -> Numbers:
    """Return the second derivative of a place, smoothed before, as noise is amplified twice."""
    step = float(np.median(np.diff(seconds)))
    place = smooth_columns(position, hann_kernel(KERNEL, step)) if step > 0.0 else position
    return differentiate(differentiate(place, seconds), seconds)


def derive_vector(
    kind: str, turn: Rotation, position: Numbers | None, seconds: Numbers
) -> Numbers:
    """
    Return what rates, velocity or specific force in the body a pose implies, shape (n, 3).

    `kind`: 'rates', 'velocity' or 'force'; only rates need no position. [rad/s, m/s, m/s2]
    """
    if kind == 'rates':
        return body_rates_of(turn, seconds)
    assert position is not None
    if kind == 'velocity':
        return turn.inv().apply(differentiate(position, seconds))
    # An accelerometer at rest feels +g along z (up)
    gravity = np.array([0.0, 0.0, STANDARD_GRAVITY])
    return turn.inv().apply(smooth_acceleration(position, seconds) + gravity)


def measure_forwardness(turn: Rotation, evidence: MotionEvidence) -> tuple[float, float]:
    """
    Return how steadily a vehicle moves along one direction of its body, and along its x axis.

    An airship moves where it points; with a wrong sign of its heading, it would not. Both are at
    most 1.
    """
    if evidence.position is None:
        return 0.0, 0.0
    speed = differentiate(evidence.position, evidence.seconds)
    speed = smooth_columns(np.nan_to_num(speed), np.full(SPEED_ROWS, 1.0 / SPEED_ROWS))
    fast = np.linalg.norm(speed, axis=1)
    moving = np.flatnonzero(fast > 0.5 * float(np.percentile(fast, 90.0)))
    if not len(moving) or not fast[moving].all():
        return 0.0, 0.0
    along = (turn.inv().apply(speed)[moving] / fast[moving, None]).mean(axis=0)
    return float(np.linalg.norm(along)), float(along[0])
