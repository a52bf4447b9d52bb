"""
Detect clocks that disagree: one motion at two times, or with a drifting lag.

The lag is where two sources of a motion correlate best. Its uncertainty is the spread of the lags
of separate parts of the flight.
"""

from collections.abc import Iterator
from typing import final, NamedTuple

from lta_data.data_quality import limits
from lta_data.data_quality.finding import CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.motion_pairs import (
    estimate_lag,
    high_pass_pair,
    MotionPair,
    PairSimilarity,
)
from lta_data.data_quality.recording import CheckContext
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
KIND = 'clock'
PART = 5.0  # target length of the parts of a flight [s]
PARTS = (3, 12)  # least and largest number of parts
INDEPENDENT = 4.0  # independent values per second after a kernel of 0.25 s
EVEN = 1.0  # weight of a part's length relative to its motion
SHORTEST = 1.0  # shortest part whose lag is used [s]
# Trial drifts over the whole flight [s], for drifts that the parts' lags cannot follow
DRIFTS = tuple(size * sign for size in (0.2, 0.35, 0.5, 0.65, 0.8, 1.0) for sign in (1.0, -1.0))
NEAR = 0.6  # largest deviation of a part's lag from the total lag [s]
NORMAL = 1.4826  # standard deviation over median absolute deviation
MEDIAN = 1.2533  # standard error of a median over that of a mean


@final
class PairLag(NamedTuple):
    """
    A lag and its standard error, and its drift over the flight with standard error. [s]

    `line` is the lag in the middle of the flight [s] and its slope [s/s].
    """

    lag: float
    error: float
    drift: float
    drift_error: float
    line: tuple[float, float]


def find_clock_errors(evidence: CheckContext) -> CheckVerdict:
    """Find channels that are late or early relative to others."""
    findings: list[QualityFinding] = []
    unjudged: list[str] = []
    turning = {
        pair.sensor.split('/')[0] for pair, _ in evidence.pair_similarities if pair.what == 'rates'
    }
    for pair, alike in evidence.pair_similarities:
        if pair.what == 'force' and pair.sensor.split('/')[0] in turning:
            continue  # the rates of this sensor are more precise
        if alike is None:
            unjudged.append(
                f"The clock of '{pair.sensor}' cannot be judged: '{pair.reference}' shows too "
                'little motion to compare it with.'
            )
        else:
            findings += find_lag(pair, alike)
    return CheckVerdict(tuple(findings), tuple(unjudged))


def find_lag(pair: MotionPair, alike: PairSimilarity) -> Iterator[QualityFinding]:
    """Yield the lag of a pair, or its drift, if significant."""
    if not alike.quick_at_lag.any():
        return
    estimate = estimate_pair_lag(pair, alike)
    begin, end = pair.span
    steady, drifting = (
        drift_corrected_correlation(pair, estimate.lag, 0.0),
        drift_corrected_correlation(pair, *estimate.line),
    )
    wanders = (
        abs(estimate.drift) > limits.CLOCK_OFFSET + limits.CLOCK_SIGMAS * estimate.drift_error
    )
    if wanders and drifting > limits.AGREE and is_clear_gain(steady, drifting):
        yield QualityFinding(
            KIND, pair.sensor, begin, end,
            f'The time stamps drift by {estimate.drift:.3f} s +- {estimate.drift_error:.3f} s '
            f"relative to '{pair.reference}' from start to end: without this drift the two would "
            f'have a correlation of {drifting:.2f} instead of {steady:.2f}.',
            Severity.SUSPICIOUS, {'drift': estimate.drift, 'error': estimate.drift_error},
        )  # fmt: skip
        return
    # A large drift blurs the total correlation, so the lag above may be meaningless
    if steady < limits.AGREE:
        drift, drifting = search_clock_drift(pair)
        if drifting > limits.WANDER_AGREE and is_clear_gain(max(steady, 0.0), drifting):
            yield QualityFinding(
                KIND, pair.sensor, begin, end,
                f'The time stamps drift by about {drift:.1f} s relative to '
                f"'{pair.reference}' from "
                f'start to end (correlation {steady:.2f} as recorded, {drifting:.2f} after '
                'correction).',
                Severity.SUSPICIOUS, {'drift': drift},
            )  # fmt: skip
            return
    own, zero = np.abs(alike.quick_at_lag), np.abs(alike.quick_at_zero)
    best = own >= min(limits.AGREE, float(own.max()))  # ignore axes with poor correlation
    peak = float(own[best].mean())
    clear = abs(estimate.lag) > limits.CLOCK_OFFSET + limits.CLOCK_SIGMAS * estimate.error
    # Swapped axes would give a meaningless lag.
    if clear and alike.axes_agree and peak > limits.AGREE and is_clear_gain(
        float(zero[best].mean()), peak
    ):  # fmt: skip
        word = 'late' if estimate.lag > 0 else 'early'
        yield QualityFinding(
            KIND, pair.sensor, begin, end,
            f'The data are {abs(estimate.lag):.3f} s +- {estimate.error:.3f} s {word} relative to '
            f"'{pair.reference}' (correlation {zero[best].mean():.2f} as recorded, {peak:.2f} "
            'after correction).',
            Severity.SUSPICIOUS, {'lag': estimate.lag, 'error': estimate.error},
        )  # fmt: skip


def search_clock_drift(pair: MotionPair) -> tuple[float, float]:
    """Return the drift over the flight with the best correlation [s], and that correlation."""
    left, right, _, _ = high_pass_pair(pair)
    length = float(np.ptp(pair.grid))
    best = 0.0, 0.0
    for drift in DRIFTS:
        # Half of the drift before and half after the middle, so that the mean lag is unchanged
        at = pair.grid + drift * ((pair.grid - pair.grid[0]) / length - 0.5)
        moved = np.stack([np.interp(at, pair.grid, column) for column in left.T], axis=1)
        lag = estimate_lag(moved, right, pair.step, limits.CLOCK_SEARCH)
        score = drift_corrected_correlation(pair, lag, drift / length)
        best = max(best, (drift, score), key=lambda way: way[1])
    return best


def is_clear_gain(before: float, after: float) -> bool:
    """Return whether an improved correlation clearly reduces the mismatch."""
    return 1.0 - before > limits.CLOCK_GAIN * (1.0 - after)


def drift_corrected_correlation(pair: MotionPair, lag: float, slope: float) -> float:
    """Return the correlation of the fast motion of all axes after removing a drifting lag. [1]"""
    left, right, left_size, right_size = high_pass_pair(pair)
    at = pair.grid + lag + slope * (pair.grid - pair.grid.mean())
    moved = np.stack([np.interp(at, pair.grid, column) for column in left.T], axis=1)
    # Restore the units that the filter normalised, so that strong motion counts most
    left, right = moved * left_size, right * right_size
    size = float(np.linalg.norm(left) * np.linalg.norm(right))
    return float((left * right).sum()) / size if size > 0.0 else 0.0


def estimate_pair_lag(pair: MotionPair, alike: PairSimilarity) -> PairLag:
    """Estimate the lag of a pair from parts of the flight with equal motion."""
    left, right, _, _ = high_pass_pair(pair)
    # Axes that correlate well determine the lag.
    weight = np.abs(alike.quick_at_lag) ** 2
    left, right = left * weight, right * weight
    step, moved = pair.step, round(alike.lag / pair.step)
    # Remove the total lag first; the parts then estimate only the remainder
    left = np.roll(left, -moved, axis=0)
    energy = (right**2).sum(axis=1)
    # Cut where the accumulated motion is equal, so that each part determines a lag.
    gone = np.cumsum(energy + EVEN * energy.mean())
    count = int(np.clip(len(left) * step / PART, *PARTS))
    cuts = np.searchsorted(gone, gone[-1] * np.arange(1, count) / count)
    rows, times = [], []
    for part in np.split(np.arange(len(left)), cuts):
        if len(part) * step < SHORTEST:
            continue
        near = estimate_lag(left[part], right[part], step, NEAR)
        rows.append(moved * step + near)
        # The lag belongs to the time of most motion; 1e-12 avoids weights of zero
        times.append(float(np.average(pair.grid[part], weights=energy[part] + 1e-12)))
    if len(rows) < PARTS[0]:
        return PairLag(alike.lag, lag_standard_error(right, energy, alike, step), 0.0, np.inf,
                   (alike.lag, 0.0))  # fmt: skip
    return fit_lag_drift(np.array(rows), np.array(times), step, float(pair.grid.mean()))


def lag_standard_error(right: Array, energy: Array, alike: PairSimilarity, step: float) -> float:
    """
    Return the standard error of a lag estimated from one short stretch of motion. [s]

    Twice the bound of Knapp and Carter (1976, doi:10.1109/TASSP.1976.1162830) for the given
    correlation, with the number of independent values that the kernel leaves in the stretch.
    """
    alike_at = float(np.abs(alike.quick_at_lag).max())
    lasting = float(energy.sum() ** 2 / (energy**2).sum()) * step
    turning = float(np.sqrt((np.gradient(right, step, axis=0) ** 2).sum() / (right**2).sum()))
    values = max(1.0, lasting * INDEPENDENT)
    unlike = max(1e-4, 1.0 - alike_at**2)
    return 2.0 * float(np.sqrt(unlike / values)) / alike_at / turning


def fit_lag_drift(parts: Array, times: Array, step: float, center: float) -> PairLag:
    """Fit lag [s] and drift [1] to the lags of the parts."""
    middle = float(np.median(parts))
    # A tenth of a grid step is the least error of an interpolated peak
    spread = NORMAL * float(np.median(np.abs(parts - middle))) + 0.1 * step
    error = MEDIAN * spread / np.sqrt(len(parts))
    if len(parts) < PARTS[0] + 1:
        return PairLag(middle, error, 0.0, np.inf, (middle, 0.0))
    first, second = np.triu_indices(len(parts), 1)
    apart = times[second] - times[first]
    # The median of the slopes of all pairs (Theil 1950, Sen 1968) tolerates outliers.
    slope = float(np.median((parts[second] - parts[first]) / np.maximum(apart, 1e-3)))
    at_middle = float(np.median(parts - slope * (times - center)))
    left = parts - at_middle - slope * (times - center)
    rest = NORMAL * float(np.median(np.abs(left))) + 0.1 * step
    length = float(np.ptp(times))
    drift_error = rest / float(np.linalg.norm(times - times.mean())) * length
    return PairLag(middle, error, slope * length, drift_error, (at_middle, slope))
