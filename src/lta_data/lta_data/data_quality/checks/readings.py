# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Judge how the motion in a recording was read: units, axes, frames and orders of sensor and pose.

Each other reading of a sensor, an attitude or a place is scored by the kinematics that decide the
draft of an import, too. A finding requires that one explains the data and the recorded one does
not, so that noise or a poor sensor does not cause one.
"""

from collections.abc import Iterator, Sequence
from typing import Final, final, NamedTuple

from lta_config.constants import DEGREES_PER_RADIAN
from lta_data.data_quality import limits
from lta_data.data_quality.motion import (
    MeasuredVector,
    MOVING_SPREADS,
    PoseMotion,
    PoseSeries,
    VectorSeries,
)
from lta_data.data_quality.recording import (
    CheckContext,
    CheckVerdict,
    QualityFinding,
    select_first_findings,
    Severity,
)
from lta_data.interpretation.attitude_readings import AttitudeReading, list_readings
from lta_data.interpretation.column_group import ColumnGroup
from lta_data.interpretation.kinematics import (
    FILTER_DELAY,
    iterate_moments,
    ScaleFit,
    SIGNED_AXES,
    UNIT_FACTORS,
)
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
KIND: Final = 'axes'
UNIT_KIND: Final = 'unit'
XYZ: Final = 'xyz'
REREADING_GAIN: Final = 0.2  # least gain of the score of a vector by another reading
EXPLAINED_SCORE: Final = 0.6  # least score of a reading that explains a vector
AGREES: Final = 0.25  # share of each axis from which it needs no other reading
OTHER: Final = 0.05  # of a score, that an attitude must gain more than a sensor
CHANGE: Final = 0.01  # of a score, that each changed axis must gain
CORRELATED: Final = limits.MOTION_CORRELATION**2  # share from which the factor is that of a unit
HEIGHT_UNITS: Final = {'range': {'mm': 1e3, 'cm': 100.0}, 'pressure': {'hPa': 0.01, 'kPa': 1e-3}}
# Ratio of measured to derived values -> unit of the sensor
FACTORS: Final[dict[str, dict[float, str]]] = {
    kind: {factor: unit for unit, factor in units.items() if factor != 1.0}
    for kind, units in (UNIT_FACTORS | HEIGHT_UNITS).items()
}
# The same ratio -> unit of the pose, if that is wrong
POSE_FACTORS: Final[dict[str, dict[float, str]]] = {
    'velocity': {0.001: 'mm', 0.01: 'cm'},
    'range': {0.001: 'mm', 0.01: 'cm'},
    'pressure': {0.001: 'mm'},
    'rates': {1.0 / DEGREES_PER_RADIAN: 'deg'},
}


# Labels of another order of a quaternion, and what its fields contain then
QUATERNION_ORDERS: Final = {
    'quaternion xyzw': '',
    'quaternion xyzw against the names': 'The quaternion fields w, x, y, z contain x, y, z, w',
    'quaternion wxyz against the names': 'The quaternion fields x, y, z, w contain w, x, y, z',
}
INVERTED: Final = 'The attitude is inverted (map to body)'
QUATERNION_GROUP: Final = ColumnGroup('quaternion', '', tuple('xyzw'), tuple('xyzw'), '', '')
EULER_ANGLES: Final = ('roll', 'pitch', 'yaw')
EULER: Final = ColumnGroup('euler', '', EULER_ANGLES, EULER_ANGLES, 'rad', '')


@final
class AxesFit(NamedTuple):
    """How a vector fits as recorded, and with the axes that explain it best."""

    recorded: ScaleFit
    best: ScaleFit
    axes: Array  # from the recorded axes to those that fit
    moving: NDArray[np.bool_]  # axes that move enough to judge

    @property
    def agrees(self) -> bool:
        """Whether each moving axis fits well enough to need no explanation."""
        return self.recorded.worst > AGREES


@final
class Reading(NamedTuple):
    """Another reading of a channel, with the score of a vector."""

    score: float
    channel: str
    words: str


def fit_axes(
    measured: Array,
    derived: Array,
    seconds: Array,
    least: float,
    orders: Sequence[Array] = SIGNED_AXES,
) -> AxesFit | None:
    """
    Fit a vector in signed orders of its axes; None if none of the derived axes moves.

    `least`: standard deviation of a derived axis that counts as motion.
    """
    one, other = (side - np.nanmean(side, axis=0) for side in (measured, derived))
    stack = np.array(orders)
    costs = [CHANGE * count_changes(axes) for axes in orders]
    fits = []
    for moments in iterate_moments(one, other, seconds, FILTER_DELAY, -FILTER_DELAY):
        moving = (moments.derived > least**2 * moments.rows) & (moments.measured > 0.0)
        if moving.any():
            ways = moments.fit_orders(stack, moving)
            k = max(range(len(ways)), key=lambda k: ways[k].score - costs[k])
            fits.append((ways[k].score - costs[k], AxesFit(ways[0], ways[k], orders[k], moving)))
    if not fits:
        return None
    recorded = max((fit.recorded for _, fit in fits), key=lambda fit: fit.score)
    return max(fits, key=lambda fit: fit[0])[1]._replace(recorded=recorded)


def count_changes(axes: Array) -> int:
    """Return how many axes a signed permutation, shape (3, 3), moves or turns around."""
    return int(3 - np.sum(np.diag(axes) > 0.0))


def find_misreadings(motion: PoseMotion) -> Iterator[QualityFinding]:
    """Yield the readings of axes, frames and orders that explain a pose and its sensors better."""
    fits = {
        vector.name: fit
        for vector in motion.vectors
        if (fit := _fit_vector(motion, vector, orders=SIGNED_AXES)) is not None
    }
    vectors = [vector for vector in motion.vectors if vector.name in fits]
    doubtful = [vector for vector in vectors if not fits[vector.name].agrees]
    if not doubtful:
        return
    best = {vector.name: _explain_vector(motion, vector, fits[vector.name]) for vector in vectors}
    whole = sum(best[vector.name].score for vector in vectors)
    attitudes = [*_read_attitude(motion, vectors)]
    attitude = max(attitudes, key=lambda one: one.score, default=None)
    if attitude is not None and attitude.score > whole:
        recorded = sum(fits[vector.name].recorded.score for vector in vectors)
        if (
            attitude.score > EXPLAINED_SCORE * len(vectors)
            and attitude.score > recorded + REREADING_GAIN
        ):
            count = len(vectors)
            yield _build(motion, attitude, doubtful[0].name, recorded / count,
                         attitude.score / count)  # fmt: skip
            return
    for vector in doubtful:
        reading, recorded = best[vector.name], fits[vector.name].recorded.score
        if reading.words and reading.score > max(EXPLAINED_SCORE, recorded + REREADING_GAIN):
            other = motion.name_reference(vector.kind)
            other = other if reading.channel != other else vector.name
            yield _build(motion, reading, other, recorded, reading.score)


def _build(
    motion: PoseMotion, reading: Reading, other: str, before: float, after: float
) -> QualityFinding:
    return QualityFinding(
        KIND, reading.channel, *motion.span,
        f"{reading.words}: the agreement with '{other}' is {100 * max(0.0, before):.0f} % as "
        f'recorded and {100 * after:.0f} % after correction.',
        Severity.SUSPICIOUS, {'as_told': before, 'explained': after},
    )  # fmt: skip


def _fit_vector(
    motion: PoseMotion,
    vector: MeasuredVector,
    turn: Rotation | None = None,
    place: Array | None = None,
    orders: Sequence[Array] = SIGNED_AXES[:1],
) -> AxesFit | None:
    derived = motion.derive(vector.kind, turn, place)
    return fit_axes(vector.values, derived, motion.seconds, MOVING_SPREADS[vector.kind], orders)


def _explain_vector(motion: PoseMotion, vector: MeasuredVector, fit: AxesFit) -> Reading:
    """Return the reading of a sensor, or of the place that it is compared with, that fits best."""
    ways = [Reading(fit.recorded.score, vector.name, '')]
    if fit.agrees:
        return ways[0]
    wrong = [j for j in np.flatnonzero(fit.moving).tolist() if fit.axes[j, j] <= 0.0]
    if wrong:
        words = ', '.join(f'{XYZ[j]} is recorded as {_name_axis(fit.axes[j])}' for j in wrong)
        name = f'{vector.name}.{XYZ[wrong[0]]}' if len(wrong) == 1 else vector.name
        score = fit.best.score - CHANGE * count_changes(fit.axes)
        ways.append(Reading(score, name, f'Axes are swapped or inverted ({words})'))
    if vector.kind == 'velocity':
        ways += _read_velocity(motion, vector)
    return max(ways, key=lambda way: way.score)


def _read_velocity(motion: PoseMotion, vector: MeasuredVector) -> Iterator[Reading]:
    """Yield the readings of a velocity in another frame, and of a place in other axes."""
    level = Rotation.identity(len(motion.seconds))
    frames = (
        (motion.derive('velocity', level),
         'The velocity is in the map frame instead of the body frame'),
        (motion.turn.inv().apply(motion.derive('velocity')),
         'The body velocity was rotated into the body once more'),
    )  # fmt: skip
    for derived, words in frames:
        fit = fit_axes(
            vector.values, derived, motion.seconds, MOVING_SPREADS['velocity'], SIGNED_AXES[:1]
        )
        if fit is not None:
            yield Reading(fit.recorded.score - OTHER, vector.name, words)
    assert motion.place is not None
    for axes in SIGNED_AXES[1:]:
        other = _fit_vector(motion, vector, place=motion.place @ axes.T)
        if other is not None:
            words = ', '.join(_name_axis(row) for row in axes)
            score = other.recorded.score - OTHER - CHANGE * count_changes(axes)
            channel = motion.name_reference('velocity')
            yield Reading(
                score, channel, f'The axes x, y, z of the position are recorded as {words}'
            )


def _read_attitude(motion: PoseMotion, vectors: list[MeasuredVector]) -> Iterator[Reading]:
    """Yield other readings of an attitude, with the sum of the scores of its vectors."""
    for words, reading in _list_attitudes(motion):
        fits = [_fit_vector(motion, vector, reading.turn) for vector in vectors]
        scores = [fit.recorded.score - OTHER for fit in fits if fit is not None]
        if len(scores) == len(vectors):
            yield Reading(sum(scores) - reading.cost, motion.attitude.name, words)


def _list_attitudes(motion: PoseMotion) -> Iterator[tuple[str, AttitudeReading]]:
    """Yield how an attitude can have been misread: as a quaternion, and by signs of angles."""
    for one in list_readings(QUATERNION_GROUP, motion.attitude.values):
        label, _, direction = one.label.rpartition(', ')
        words = [QUATERNION_ORDERS[label], INVERTED if direction == 'world to body' else '']
        if any(words):
            yield '; '.join(filter(None, words)), one
    for one in list_readings(EULER, motion.turn.as_euler('ZYX')[:, ::-1]):
        if one.entry['direction'] == 'body to world' and one.entry['unit'] == 'rad' and (
            one.entry['sequence'] == 'ZYX' and 'signs' in one.entry
        ):  # fmt: skip
            signs = zip(EULER_ANGLES[::-1], one.entry['signs'], strict=True)
            names = [name for name, sign in signs if sign < 0]
            verb = 'angle is' if len(names) == 1 else 'angles are'
            yield f'The {" and ".join(names)} {verb} inverted', one


def _name_axis(row: Array) -> str:
    """Return the name of a signed axis, such as -y."""
    return ('-' if row.sum() < 0.0 else '') + XYZ[int(np.abs(row).argmax())]


def find_units_by_motion(motion: PoseMotion) -> Iterator[QualityFinding]:
    """Yield the vectors whose size is that of the derived ones in another unit."""
    for vector in motion.vectors:
        fit = _fit_vector(motion, vector, orders=SIGNED_AXES)
        # Of the best axes, so that swapped ones do not hide a wrong unit
        if fit is not None and fit.best.share > CORRELATED:
            reference = motion.name_reference(vector.kind)
            yield from name_factor(
                vector.kind, vector.name, reference, fit.best.ratio, motion.span
            )


def name_factor(
    kind: str, sensor: str, reference: str, ratio: float, span: tuple[float, float]
) -> Iterator[QualityFinding]:
    """Yield the factor between a sensor and its reference if it is that of a unit."""
    for table, name in ((FACTORS, sensor), (POSE_FACTORS, reference)):
        for factor, unit in table.get(kind, {}).items():
            if abs(ratio / factor - 1.0) <= limits.FACTOR_SPREAD:
                text = (
                    f"the motion is {ratio:.4g} times that expected from '{reference}'."
                    if name == sensor
                    else f"'{sensor}' moves {ratio:.4g} times as much."
                )
                yield QualityFinding(
                    UNIT_KIND, name, *span, f'The unit looks like {unit}: {text}',
                    Severity.SUSPICIOUS, {'factor': ratio},
                )  # fmt: skip
                return


def find_axis_errors(evidence: CheckContext) -> CheckVerdict:
    """Find flipped and swapped axes, wrong frames and wrong quaternion orders."""
    findings: list[QualityFinding] = []
    for motion in evidence.motions:
        findings += find_misreadings(motion)
    for pose in evidence.poses:
        findings += find_lying_attitude(pose)
    for sensor in evidence.inertials:
        if sensor.force is not None:
            findings += find_misaligned_gravity(sensor.force)
    return CheckVerdict(select_first_findings(findings))


def find_lying_attitude(pose: PoseSeries) -> Iterator[QualityFinding]:
    """Yield a finding if the attitude puts the vehicle on its side or back most of the time."""
    if pose.attitude is None or len(pose.attitude.time) < limits.LEAST_SAMPLES:
        return
    turn = pose.attitude.values
    # z component of the body's z axis in the world.
    up = 1.0 - 2.0 * (turn[:, 0] ** 2 + turn[:, 1] ** 2)
    share = float(np.mean(up < np.cos(np.radians(limits.UPRIGHT_TILT))))
    if share > 0.5:
        yield QualityFinding(
            KIND, pose.attitude.name, float(pose.attitude.time[0]), float(pose.attitude.time[-1]),
            f'The vehicle seems to tilt by more than {limits.UPRIGHT_TILT:.0f} degrees for '
            f'{100 * share:.0f} % of the time: probably the quaternion has the wrong order '
            '(w first), or the z axis points down.',
            Severity.SUSPICIOUS, {'share': share},
        )  # fmt: skip


def find_misaligned_gravity(force: VectorSeries) -> Iterator[QualityFinding]:
    """Yield an accelerometer without +g along z at rest (FLU)."""
    if len(force.time) < limits.LEAST_SAMPLES:
        return
    # The median is insensitive to impacts
    mean = np.median(force.values, axis=0)
    size = float(np.linalg.norm(mean))
    spread = float(np.median(np.linalg.norm(force.values, axis=1)))
    # Without a dominant direction the sensor rotates too much to judge.
    if size < 0.7 * spread or mean[2] > size * np.cos(np.radians(limits.UPRIGHT_TILT)):
        return
    axis = int(np.argmax(np.abs(mean)))
    sign = '-' if mean[axis] < 0 else ''
    yield QualityFinding(
        KIND, f'{force.name}.z' if axis == 2 else force.name, float(force.time[0]),
        float(force.time[-1]),
        f'The accelerometer measures gravity along {sign}{XYZ[axis]} (x, y, z: {mean[0]:.2f}, '
        f'{mean[1]:.2f}, {mean[2]:.2f} m/s2), but at rest it should measure +9.81 m/s2 along z '
        '(REP-103).',
        Severity.SUSPICIOUS, {'x': float(mean[0]), 'y': float(mean[1]), 'z': float(mean[2])},
    )  # fmt: skip
