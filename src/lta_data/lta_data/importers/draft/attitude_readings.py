"""Try the readings of an attitude: order, direction, sequence, unit; physics decides."""

from collections.abc import Iterator
from typing import Any, Final, final, NamedTuple

from lta_data.data_quality.smoothing import hann_kernel, smooth_columns
from lta_data.importers.draft.column_groups import ColumnGroup, measure_length
from lta_data.importers.draft.name_hints import HEADINGS, parse_column_name, WORDS
from lta_data.importers.log_table import Numbers
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

KERNEL: Final = 0.25  # that smooths both sides of a comparison [s]
LONGEST: Final = 20_000  # rows that are looked at
UNCLEAR: Final = (7.0, 40.0)  # a larger heading is unlikely in radians, and is in degrees
UPRIGHT: Final = (3.3, 1.65)  # a larger roll or pitch is in degrees
STILL: Final = 1.0  # a vehicle in flight turns by more, in degrees
LATEST: Final = 0.3  # that a derived velocity is late: labs filter it [s]
CLEAR: Final = 0.05  # advantage of a reading that decides
SAME: Final = 3.0  # readings that differ by less are the same in this flight [deg]
SMOOTHED: Final = 9  # rows over which a speed is averaged
FLIP: Final = np.array([1.0, -1.0, -1.0])  # of y and z: FRD instead of FLU
UNUSUAL: Final = 0.1  # of a score, that flipped axes of a sensor must gain
AGREE: Final = 0.6  # explained share of a motion that counts as agreement


@final
class AttitudeReading(NamedTuple):
    """One reading: its words, its entry in a mapping, and the attitude from body to world."""

    label: str
    entry: dict[str, Any]
    turn: Rotation


@final
class MotionEvidence(NamedTuple):
    """Quantities of one table on its times, shape (n, 3) each; None where they are missing."""

    seconds: Numbers
    position: Numbers | None
    velocity: Numbers | None
    rates: Numbers | None
    acceleration: Numbers | None
    # Of an inertial sensor, whose y and z may both point the other way
    sensed: Numbers | None = None


@final
class ScaleFit(NamedTuple):
    """
    Least-squares factor of a measured on a derived vector, and the share it explains.

    `axes` is the mean share of the single axes, so that a turning vehicle's yaw does not hide the
    sign of its pitch.
    """

    factor: float
    share: float
    axes: float = 0.0

    @property
    def score(self) -> float:
        """How well both agree, from -1 to 1."""
        return 0.5 * (self.share + self.axes)


def list_readings(
    group: ColumnGroup, numbers: Numbers, sequence: str = ''
) -> Iterator[AttitudeReading]:
    """
    Yield the readings of a group, the conventional one first.

    `sequence`: of the angles about x, y and z, as the file states it; '' if it does not.
    """
    if group.kind == 'quaternion':
        yield from _read_quaternions(group, numbers)
    else:
        if group.axes == ('x', 'y', 'z') and group.columns[0].lower().startswith('rx'):
            yield from _read_vectors(group, numbers)
        yield from _read_angles(group, numbers, sequence if group.axes == ('x', 'y', 'z') else '')


def _read_quaternions(group: ColumnGroup, numbers: Numbers) -> Iterator[AttitudeReading]:
    orders = ('xyzw', 'wxyz')
    columns = dict(zip(group.axes, group.columns, strict=True))
    named, length = 'w' in columns, measure_length(numbers)
    for order in orders[:1] if named else orders:
        listed = [columns[axis] for axis in 'xyzw'] if named else list(group.columns)
        indices = [group.columns.index(column) for column in listed]
        rows = numbers[:, indices] if order == 'xyzw' else numbers[:, indices][:, [1, 2, 3, 0]]
        turn = Rotation.from_quat(_fill_rows(rows, [0.0, 0.0, 0.0, 1.0]))
        for direction in ('body to world', 'world to body'):
            entry: dict[str, Any] = {'quaternion': listed, 'order': order, 'direction': direction}
            entry |= {} if length == 1.0 else {'length': length}
            label = f'quaternion {order if not named else "".join(group.axes)}, {direction}'
            yield AttitudeReading(
                label, entry, turn if direction == 'body to world' else turn.inv()
            )


def _read_vectors(group: ColumnGroup, numbers: Numbers) -> Iterator[AttitudeReading]:
    """Yield the readings as axis times angle, as Vicon writes RX, RY, RZ."""
    vectors = _fill_rows(numbers, [0.0] * 3)
    unit = 'deg' if np.abs(vectors).max() > UNCLEAR[0] or group.unit.startswith('deg') else 'rad'
    turn = Rotation.from_rotvec(vectors, degrees=unit == 'deg')
    for direction in ('body to world', 'world to body'):
        entry = {'rotation_vector': list(group.columns), 'unit': unit, 'direction': direction}
        yield AttitudeReading(
            f'rotation vector, {unit}, {direction}', entry,
            turn if direction == 'body to world' else turn.inv(),
        )  # fmt: skip


def _read_angles(group: ColumnGroup, numbers: Numbers, sequence: str) -> Iterator[AttitudeReading]:
    # A heading alone is the attitude of a level vehicle
    alone = len(group.columns) == 1
    usual = ('Z',) if alone else ('ZYX', 'XYZ')
    orders = [
        (one, (0,) if alone else tuple(map('XYZ'.index, one)))
        for one in ((sequence,) if sequence else usual)
    ]
    angles = _fill_rows(numbers, [0.0] * len(group.columns))
    for unit in _list_angle_units(group, angles):
        for direction in ('body to world', 'world to body'):
            for name, order in orders:
                for signs, compass in _list_senses(group, angles, name, direction):
                    listed = [group.columns[index] for index in order]
                    quarter = 90.0 if unit == 'deg' else 0.5 * np.pi
                    offsets = [quarter * compass, 0.0, 0.0][: len(order)]
                    turn = Rotation.from_euler(
                        name, angles[:, order] * signs + offsets, degrees=unit == 'deg'
                    )
                    entry: dict[str, Any] = {
                        'euler': listed, 'sequence': name, 'unit': unit, 'direction': direction,
                    }  # fmt: skip
                    if -1 in signs:
                        entry['signs'] = signs
                    if compass:
                        entry['offsets'] = [float(f'{one:.9g}') for one in offsets]
                    label = f'{name}, {unit}, {direction}{_describe_sense(signs, compass)}'
                    yield AttitudeReading(
                        label, entry, turn if direction == 'body to world' else turn.inv()
                    )


def _list_senses(
    group: ColumnGroup, angles: Numbers, sequence: str, direction: str
) -> list[tuple[list[int], bool]]:
    """Return the signs that angles can have, and whether the first is a compass heading."""
    inverse = direction == 'world to body'
    if sequence == 'Z':
        senses = [([1], False)]
    elif sequence != 'ZYX':
        return [([1, 1, 1], False)] + ([([1, -1, 1], False)] if sequence == 'XYZ' else [])
    else:
        senses = [([1, 1, 1], False), ([1, -1, 1], False)]
        senses = senses[::-1] if is_crazyflie(group) else senses
        senses += [] if inverse else [([-1, 1, 1], False), ([-1, -1, 1], False)]
    if not inverse and is_compass(group, angles):
        senses += [([-1, -1, 1][: len(group.columns)], True)]
        senses += [([-1, 1, 1], True)] if len(group.columns) == 3 else []
    return senses


def _describe_sense(signs: list[int], compass: bool) -> str:
    """Return what a label adds on signs of angles."""
    if len(signs) == 1:
        heading = ', heading clockwise from north' if compass else ''
        return f'{heading}, roll and pitch taken as 0'
    words = [', heading clockwise from north' if compass else ', yaw inverted'] * (signs[0] < 0)
    return ''.join([*words, ', pitch inverted' * (signs[1] < 0)])


def is_compass(group: ColumnGroup, angles: Numbers) -> bool:
    """Return whether the yaw of a group may be a compass heading, by its name and its size."""
    words = frozenset(word.lower() for column in group.columns for word in WORDS.findall(column))
    return bool(words & HEADINGS) and float(angles[:, -1].min()) >= 0.0


def is_crazyflie(group: ColumnGroup) -> bool:
    """Return whether angles have the names of a Crazyflie, whose pitch is positive nose up."""
    words = frozenset().union(*(parse_column_name(column).words for column in group.columns))
    return group.axes == ('roll', 'pitch', 'yaw') and bool(
        words & {'stabilizer'} or {'state', 'estimate'} <= words
    )


def _list_angle_units(group: ColumnGroup, angles: Numbers) -> tuple[str, ...]:
    """Return the units that angles can have by their names and sizes."""
    if group.unit:
        return ('deg',) if group.unit.startswith(('deg', '°')) else ('rad',)
    sizes = np.percentile(np.abs(angles), 99.0, axis=0)
    spread = np.ptp(np.percentile(angles, [1.0, 99.0], axis=0), axis=0)
    tilted = len(sizes) == 3 and bool((sizes[:2] > UPRIGHT).any())
    if tilted or sizes[-1] > UNCLEAR[1]:
        return ('deg',)
    return ('rad',) if spread.max() < STILL else ('rad', 'deg')


def _fill_rows(rows: Numbers, instead: list[float]) -> Numbers:
    """Return rows without NaN and without zero quaternions."""
    good = np.isfinite(rows).all(axis=1)
    if rows.shape[1] == 4:
        good &= (rows != 0.0).any(axis=1)
    filled: Numbers = np.where(good.reshape(-1, 1), rows, np.asarray(instead))
    return filled


def fit_scale(
    measured: Numbers, derived: Numbers, seconds: Numbers, latest: float = 0.0
) -> ScaleFit:
    """
    Fit a factor of a measured on a derived vector after smoothing both; means are kept.

    `latest`: the measured vector may be as late as this, by a filter. [s]
    """
    step = float(np.median(np.diff(seconds))) if len(seconds) > 1 else 0.0
    good = np.isfinite(measured).all(axis=1) & np.isfinite(derived).all(axis=1)
    if not step > 0.0 or good.sum() < 20:
        return ScaleFit(float('nan'), 0.0)
    weights = hann_kernel(KERNEL, step)
    left, right = (_smooth_finite(side, np.asarray(good), weights) for side in (measured, derived))
    most = min(round(latest / step), int(good.sum()) // 2)
    lates = {int(late) for late in np.linspace(0, most, 7)}
    fits = [_fit_late(left, right, np.asarray(good), late) for late in sorted(lates)]
    return max(fits, key=lambda fit: fit.share)


def _smooth_finite(side: Numbers, good: NDArray[np.bool_], weights: Numbers) -> Numbers:
    """Smooth a vector, and clip the glitches of a tracker, which would decide a fit."""
    smooth = smooth_columns(np.where(good.reshape(-1, 1), side, 0.0), weights)
    end = np.percentile(np.abs(smooth[good]), 99.0, axis=0)
    return np.clip(smooth, -end, end)


def _fit_late(measured: Numbers, derived: Numbers, good: NDArray[np.bool_], late: int) -> ScaleFit:
    """Fit a factor where the measured vector is late by some samples."""
    both = good[late:] & good[: len(good) - late]
    left, right = measured[late:][both], derived[: len(good) - late][both]
    power = float((right * right).sum())
    total = float((left * left).sum())
    if power <= 0.0 or total <= 0.0:
        return ScaleFit(float('nan'), 0.0)
    product = float((left * right).sum())
    # The squared cosine between both, with the sign of the factor
    share = product * abs(product) / (power * total)
    products = (left * right).sum(axis=0)
    powers = np.maximum((left * left).sum(axis=0) * (right * right).sum(axis=0), 1e-300)
    axes = float(np.mean(products * np.abs(products) / powers))
    return ScaleFit(total / product if share > 0.0 else float('nan'), share, axes)


def differentiate(values: Numbers, seconds: Numbers) -> Numbers:
    """Return the derivative at the samples."""
    rising = np.concatenate(([True], np.diff(seconds) > 0.0))
    rates = np.full(values.shape, np.nan)
    if rising.sum() > 2:
        rates[rising] = np.gradient(values[rising], seconds[rising], axis=0)
    return rates


def body_rates_of(turn: Rotation, seconds: Numbers) -> Numbers:
    """Return the body rates of an attitude, shape (n, 3). [rad/s]"""
    step = np.diff(seconds)
    step = np.where(step > 0.0, step, np.nan)
    rates = (turn[:-1].inv() * turn[1:]).as_rotvec() / step[:, None]
    return np.concatenate([rates, rates[-1:]])


def score_reading(reading: AttitudeReading, evidence: MotionEvidence) -> tuple[float, list[str]]:
    """Return how well a reading agrees with the other quantities, and the reasons."""
    scores, reasons = [], []
    seconds, turn = evidence.seconds, reading.turn
    if evidence.rates is not None:
        fit = fit_scale(evidence.rates, body_rates_of(turn, seconds), seconds, LATEST)
        scores.append(_score_rates(fit))
        reasons.append(f'the rates follow from it by {100 * max(0.0, fit.share):.0f} %')
    if evidence.velocity is not None and evidence.position is not None:
        speed = differentiate(evidence.position, seconds)
        derived = turn.inv().apply(np.nan_to_num(speed))
        body = fit_scale(evidence.velocity, derived, seconds, LATEST)
        world = fit_scale(evidence.velocity, speed, seconds, LATEST)
        # Of a velocity in world axes, the same for all readings
        scores.append(max(body.score, world.score))
        if body.share > world.share:
            reasons.append(f'the body velocity by {100 * body.share:.0f} %')
    if evidence.acceleration is not None or evidence.sensed is not None:
        as_logged, reason = _score_inertial(turn, evidence, np.ones(3))
        flipped, other = _score_inertial(turn, evidence, FLIP)
        # The axes of most sensors are those of the attitude
        if np.mean(flipped) > np.mean(as_logged) + UNUSUAL:
            as_logged, reason = [one - UNUSUAL for one in flipped], other
        scores += as_logged
        reasons.append(reason)
    return (float(np.mean(scores)) if scores else 0.0), reasons


def is_flipped(rates: Numbers, turn: Rotation, seconds: Numbers) -> bool:
    """Return whether y and z of a sensor point the other way than those of an attitude."""
    count = min(len(seconds), len(turn), len(rates))
    derived = body_rates_of(turn[:count], seconds[:count])
    shares = [
        fit_scale(rates[:count], derived * sign, seconds[:count], LATEST).share
        for sign in (np.ones(3), FLIP)
    ]
    return shares[1] > shares[0] + UNUSUAL


def _score_rates(fit: ScaleFit) -> float:
    # A factor of 57.3 is a unit of the rates, or of the angles
    right = any(abs(np.log(fit.factor / one)) < 0.25 for one in (1.0, 57.3)) if (
        fit.share > 0.0) else False  # fmt: skip
    return fit.score if right else 0.5 * fit.score


def _score_inertial(
    turn: Rotation, evidence: MotionEvidence, flip: Numbers
) -> tuple[list[float], str]:
    """Return the scores of an attitude by an inertial sensor, whose axes may be flipped."""
    scores, reasons = [], []
    if evidence.sensed is not None:
        derived = body_rates_of(turn, evidence.seconds)
        fit = fit_scale(evidence.sensed * flip, derived, evidence.seconds, LATEST)
        scores.append(_score_rates(fit))
        reasons.append(f'the rates of the IMU follow from it by {100 * max(0.0, fit.share):.0f} %')
    if evidence.acceleration is not None:
        felt = evidence.acceleration * flip
        pull = turn.apply(np.nan_to_num(felt))
        share = float(np.linalg.norm(pull.mean(axis=0)) / (np.linalg.norm(pull, axis=1).mean()
                                                            or 1.0))  # fmt: skip
        tilt = _explain_tilt(turn, felt, pull.mean(axis=0), evidence)
        scores.append(share if tilt is None else 0.5 * (share + tilt))
        reasons.append(f'gravity keeps its direction by {100 * share:.0f} %')
    return scores, '; '.join(reasons)


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
    total = np.maximum((measured**2).sum(axis=0), 1e-300)
    return float(np.mean(np.clip(1.0 - left / total, -1.0, 1.0)))


def measure_forwardness(turn: Rotation, evidence: MotionEvidence) -> tuple[float, float]:
    """
    Return how steadily a vehicle moves along one direction of its body, and along its x axis.

    An airship moves where it points; with a wrong sign of its heading, it would not. Both are at
    most 1.
    """
    if evidence.position is None:
        return 0.0, 0.0
    speed = differentiate(evidence.position, evidence.seconds)
    speed = smooth_columns(np.nan_to_num(speed), np.full(SMOOTHED, 1.0 / SMOOTHED))
    fast = np.linalg.norm(speed, axis=1)
    moving = np.flatnonzero(fast > 0.5 * float(np.percentile(fast, 90.0)))
    if not len(moving) or not fast[moving].all():
        return 0.0, 0.0
    along = (turn.inv().apply(speed)[moving] / fast[moving, None]).mean(axis=0)
    return float(np.linalg.norm(along)), float(along[0])


def typical_difference(one: Rotation, other: Rotation) -> float:
    """Return the 90th percentile of the angle between two attitudes. [deg]"""
    return float(np.percentile(np.degrees((one.inv() * other).magnitude()), 90.0))
