"""
Detect signs and axes that violate REP-103: flipped, swapped, wrong frame or component order.

If two sources of a motion disagree by axis, all signed permutations of the axes, the other frame
and other readings of the quaternion are tried. A finding requires that one of them explains the
data, so that noise or a poor sensor does not cause one.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import permutations, product
from typing import Final

from lta_data.data_quality import limits
from lta_data.data_quality.finding import (
    CheckVerdict,
    QualityFinding,
    select_first_findings,
    Severity,
)
from lta_data.data_quality.motion import PoseSeries, remove_sign_jumps, VectorSeries
from lta_data.data_quality.motion_pairs import (
    interpolate_attitude,
    measure_similarity,
    MotionPair,
    pair_force,
    pair_rates,
    pair_velocity,
    PairSimilarity,
)
from lta_data.data_quality.recording import CheckContext
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
KIND = 'axes'
XYZ: Final = 'xyz'
OTHER = 0.05  # advantage of blaming the sensor's side over the pose
BETTER = 0.25  # least improvement of the match by an explanation


def _flip_angles(turn: Array, signs: tuple[float, float, float]) -> Array:
    """Return attitudes with other signs of yaw, pitch and roll."""
    angles = Rotation.from_quat(turn).as_euler('ZYX') * np.array(signs)
    return np.asarray(Rotation.from_euler('ZYX', angles).as_quat())


# Misreadings of an attitude, rows of x, y, z, w
ORDERS: Final[dict[str, Callable[[Array], Array]]] = {
    'The attitude is inverted (map to body)': lambda turn: (
        turn * np.array([-1.0, -1.0, -1.0, 1.0])
    ),
    'The quaternion fields x, y, z, w contain w, x, y, z': lambda turn: np.roll(turn, -1, axis=1),
    'The quaternion fields w, x, y, z contain x, y, z, w': lambda turn: np.roll(turn, 1, axis=1),
    'The pitch angle is inverted': lambda turn: _flip_angles(turn, (1.0, -1.0, 1.0)),
    'The yaw angle is inverted': lambda turn: _flip_angles(turn, (-1.0, 1.0, 1.0)),
}
# All 48 signed orders of three axes, mirrored ones included
SIGNED: Final = tuple(product(permutations(range(3)), product((1.0, -1.0), repeat=3)))


def find_axis_errors(evidence: CheckContext) -> CheckVerdict:
    """Find flipped and swapped axes, wrong frames and wrong quaternion orders."""
    findings: list[QualityFinding] = []
    by_name = {pose.attitude.name: pose for pose in evidence.poses if pose.attitude is not None}
    by_place = {pose.position.name: pose for pose in evidence.poses if pose.position is not None}
    for pair, alike in evidence.pair_similarities:
        if alike is None or alike.axes_agree:
            continue
        pose = by_name.get(pair.reference) or by_place.get(pair.reference)
        findings += explain_mismatch(pair, alike, pose)
    for pose in evidence.poses:
        findings += find_lying_attitude(pose)
    for sensor in evidence.inertials:
        if sensor.force is not None:
            findings += find_misaligned_gravity(sensor.force)
    return CheckVerdict(select_first_findings(findings))


def mean_axis_match(alike: PairSimilarity) -> float:
    """Return the mean match of the moving axes with their counterparts. [1]"""
    return float(np.diag(alike.match)[alike.moving].mean())


def explain_mismatch(
    pair: MotionPair, alike: PairSimilarity, pose: PoseSeries | None
) -> Iterator[QualityFinding]:
    """Yield the best explanation of mismatching axes, if there is a good one."""
    ways = [*score_axis_orders(pair, alike)]
    if pose is not None and pair.what in ('rates', 'velocity', 'force') and len(pair.axes) == 3:
        ways += score_pose_readings(pair, pose)
    if not ways:
        return
    score, channel, words = max(ways, key=lambda way: way[0])
    before = mean_axis_match(alike)
    # Among 48 orders some match by chance, so the gain must be clear
    if score >= limits.AGREE and score > before + BETTER:
        begin, end = pair.span
        other = pair.reference if channel != pair.reference else pair.sensor
        yield QualityFinding(
            KIND, channel, begin, end,
            f"{words}: the correlation with '{other}' "
            f'is {before:.2f} as recorded and {score:.2f} after correction.',
            Severity.SUSPICIOUS, {'as_told': before, 'explained': score},
        )  # fmt: skip


def score_axis_orders(pair: MotionPair, alike: PairSimilarity) -> Iterator[tuple[float, str, str]]:
    """Yield score, channel and description of each signed order of the left side's axes."""
    if len(pair.axes) == 1:
        # A single axis can only be inverted: the correlation after inversion is the negated one
        yield -float(alike.correlation[0, 0]), pair.sensor, 'The sign is inverted'
        return
    moving = np.flatnonzero(alike.moving)
    for order, signs in SIGNED:
        # Column j of the right side corresponds to row order[j] of the left side.
        score = float(np.mean([signs[j] * alike.match[order[j], j] for j in moving]))
        wrong = [j for j in moving if order[j] != j or signs[j] < 0]
        # Changes of axes without motion are not supported by the data.
        idle = [j for j in range(3) if j not in moving and (order[j] != j or signs[j] < 0)]
        if not wrong or len(idle) > sum(order[j] != j for j in moving):
            continue
        words = ', '.join(
            f'{XYZ[j]} is recorded as {"-" if signs[j] < 0 else ""}{XYZ[order[j]]}' for j in wrong
        )
        name = f'{pair.sensor}.{XYZ[wrong[0]]}' if len(wrong) == 1 else pair.sensor
        # At the same correlation, prefer the explanation with fewer changes.
        yield (
            score - 0.01 * len(wrong) - 0.002 * len(idle),
            name,
            f'Axes are swapped or inverted ({words})',
        )


def score_pose_readings(pair: MotionPair, pose: PoseSeries) -> Iterator[tuple[float, str, str]]:
    """Yield score, channel and description of other readings of attitude and position."""
    attitude = pose.attitude
    if attitude is None:
        return
    rates = VectorSeries(pair.sensor, pair.grid[pair.valid], pair.left[pair.valid])
    for words, read in ORDERS.items():
        other = VectorSeries(
            attitude.name, attitude.time, remove_sign_jumps(read(attitude.values))
        )
        if pair.what == 'rates':
            yield from score_reading(pair_rates(rates, other), attitude.name, words)
        elif pose.position is not None:
            pairing = pair_force if pair.what == 'force' else pair_velocity
            yield from score_reading(pairing(pose.position, other, rates), attitude.name, words)
    if pair.what != 'velocity' or pose.position is None:
        return
    # The identity attitude leaves the velocity in the map frame
    level = VectorSeries(
        attitude.name, attitude.time, attitude.values * 0.0 + [0.0, 0.0, 0.0, 1.0]
    )
    in_map = pair_velocity(pose.position, level, rates)
    yield from score_reading(
        in_map, pair.sensor, 'The velocity is in the map frame instead of the body frame'
    )
    turn = interpolate_attitude(attitude, rates.time)
    again = pair_velocity(pose.position, attitude, replace(rates, values=turn.apply(rates.values)))
    yield from score_reading(
        again, pair.sensor, 'The body velocity was rotated into the body once more'
    )
    place = pose.position
    for order, signs in SIGNED:
        # The order as recorded
        if order == (0, 1, 2) and min(signs) > 0:
            continue
        moved = VectorSeries(place.name, place.time, place.values[:, order] * np.array(signs))
        words = ', '.join(f'{"-" if sign < 0 else ""}{XYZ[axis]}' for axis, sign in
                          zip(order, signs, strict=True))  # fmt: skip
        changes = sum(order[j] != j or signs[j] < 0 for j in range(3))
        for score, name, told_as in score_reading(
            pair_velocity(moved, attitude, rates), place.name,
            f'The axes x, y, z of the position are recorded as {words}',
        ):  # fmt: skip
            yield score - 0.01 * changes, name, told_as


def score_reading(
    pair: MotionPair | None, name: str, words: str
) -> Iterator[tuple[float, str, str]]:
    """Yield the score of another reading, if it can be judged."""
    alike = None if pair is None else measure_similarity(pair)
    if alike is not None:
        yield mean_axis_match(alike) - OTHER, name, words


def find_lying_attitude(pose: PoseSeries) -> Iterator[QualityFinding]:
    """Yield an attitude that has the vehicle on its side or back most of the time."""
    if pose.attitude is None or len(pose.attitude.time) < limits.LEAST_SAMPLES:
        return
    turn = pose.attitude.values
    # z component of the body's z axis in the world.
    up = 1.0 - 2.0 * (turn[:, 0] ** 2 + turn[:, 1] ** 2)
    share = float(np.mean(up < np.cos(np.radians(limits.UPRIGHT))))
    if share > 0.5:
        yield QualityFinding(
            KIND, pose.attitude.name, float(pose.attitude.time[0]), float(pose.attitude.time[-1]),
            f'The vehicle seems to tilt by more than {limits.UPRIGHT:.0f} degrees for '
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
    if size < 0.7 * spread or mean[2] > size * np.cos(np.radians(limits.UPRIGHT)):
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
