"""Try the readings of an attitude: order, direction, sequence, unit; physics decides."""

from collections.abc import Iterator
from typing import Any, Final, final, NamedTuple

from lta_data.data_quality.smoothing import hann_kernel, smooth_columns
from lta_data.importers.draft.column_groups import ColumnGroup, UNIT_NORM
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
COMMON: Final = 0.9  # of the quaternions of a log that have one length
SAME: Final = 3.0  # readings that differ by less are the same in this flight [deg]
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


@final
class ScaleFit(NamedTuple):
    """Least-squares factor of a measured on a derived vector, and the share it explains."""

    factor: float
    share: float


def list_readings(group: ColumnGroup, numbers: Numbers) -> Iterator[AttitudeReading]:
    """Yield the readings of a group, the conventional one first."""
    if group.kind == 'quaternion':
        yield from _read_quaternions(group, numbers)
    else:
        if group.axes == ('x', 'y', 'z') and group.columns[0].lower().startswith('rx'):
            yield from _read_vectors(group, numbers)
        yield from _read_angles(group, numbers)


def measure_length(rows: Numbers) -> float:
    """Return the length of logged quaternions; 1 where they have it, or none in common."""
    lengths = np.linalg.norm(rows, axis=1)
    lengths = lengths[np.isfinite(lengths) & (lengths > 0.0)]
    usual = float(np.median(lengths)) if len(lengths) else 1.0
    alike = np.abs(lengths / usual - 1.0) < UNIT_NORM
    is_other = abs(usual - 1.0) > UNIT_NORM and len(lengths) and alike.mean() > COMMON
    return float(f'{usual:.6g}') if is_other else 1.0


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


def _read_angles(group: ColumnGroup, numbers: Numbers) -> Iterator[AttitudeReading]:
    # A heading alone is the attitude of a level vehicle
    alone = len(group.columns) == 1
    orders = (('Z', (0,)),) if alone else (('ZYX', (2, 1, 0)), ('XYZ', (0, 1, 2)))
    angles = _fill_rows(numbers, [0.0] * len(group.columns))
    for unit in _list_angle_units(group, angles):
        for direction in ('body to world', 'world to body'):
            for sequence, order in orders:
                for signs in ([1],) if alone else ([1, 1, 1], [1, -1, 1]):
                    listed = [group.columns[index] for index in order]
                    turn = Rotation.from_euler(
                        sequence, angles[:, order] * signs, degrees=unit == 'deg'
                    )
                    entry: dict[str, Any] = {
                        'euler': listed, 'sequence': sequence, 'unit': unit,
                        'direction': direction,
                    }  # fmt: skip
                    if -1 in signs:
                        entry['signs'] = signs
                    nose = ', pitch inverted' if -1 in signs else ''
                    nose = ', roll and pitch taken as 0' if alone else nose
                    yield AttitudeReading(
                        f'{sequence}, {unit}, {direction}{nose}', entry,
                        turn if direction == 'body to world' else turn.inv(),
                    )  # fmt: skip


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
    return ScaleFit(total / product if share > 0.0 else float('nan'), share)


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
        # A factor of 57.3 is a unit of the rates, or of the angles
        right = any(abs(np.log(fit.factor / one)) < 0.25 for one in (1.0, 57.3)) if (
            fit.share > 0.0) else False  # fmt: skip
        scores.append(fit.share if right else 0.5 * fit.share)
        reasons.append(f'the rates follow from it by {100 * max(0.0, fit.share):.0f} %')
    if evidence.velocity is not None and evidence.position is not None:
        speed = differentiate(evidence.position, seconds)
        derived = turn.inv().apply(np.nan_to_num(speed))
        body = fit_scale(evidence.velocity, derived, seconds, LATEST)
        world = fit_scale(evidence.velocity, speed, seconds, LATEST)
        # Of a velocity in world axes, the same for all readings
        scores.append(max(body.share, world.share))
        if body.share > world.share:
            reasons.append(f'the body velocity by {100 * body.share:.0f} %')
    if evidence.acceleration is not None:
        pull = turn.apply(np.nan_to_num(evidence.acceleration))
        mean = float(np.linalg.norm(pull.mean(axis=0)))
        share = mean / float(np.linalg.norm(pull, axis=1).mean() or 1.0)
        scores.append(share)
        reasons.append(f'gravity keeps its direction by {100 * share:.0f} %')
    return (float(np.mean(scores)) if scores else 0.0), reasons


def typical_difference(one: Rotation, other: Rotation) -> float:
    """Return the 90th percentile of the angle between two attitudes. [deg]"""
    return float(np.percentile(np.degrees((one.inv() * other).magnitude()), 90.0))
