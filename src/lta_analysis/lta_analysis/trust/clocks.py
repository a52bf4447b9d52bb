"""
Clocks that do not agree: one motion seen at two times, or at a time that wanders.

The lag is where two ways of knowing a motion correlate best; its uncertainty is the spread of the
lag over parts of the flight, each on its own.
"""

from collections.abc import Iterator
from typing import final, NamedTuple

from lta_analysis.trust.evidence import Evidence
from lta_analysis.trust.finding import Finding, Severity, Verdict
from lta_analysis.trust.likeness import deviations, lag_of, Likeness
from lta_analysis.trust.limits import Limits
from lta_analysis.trust.pairs import Pair
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
KIND = 'clock'
PART = 5.0  # shortest part of a flight that has a lag of its own [s]
PARTS = (3, 12)
NEAR = 0.6  # furthest that a part's lag is looked for from the whole's [s]
NORMAL = 1.4826  # standard deviation over median deviation
MEDIAN = 1.2533  # standard error of a median over that of a mean


@final
class Lag(NamedTuple):
    """A lag and its standard error; how far it wanders over the flight, and that one's. [s]"""

    lag: float
    error: float
    drift: float
    drift_error: float


def check(evidence: Evidence) -> Verdict:
    """Find channels that are late or early against others."""
    found: list[Finding] = []
    unjudged: list[str] = []
    turning = {pair.told.split('/')[0] for pair, _ in evidence.likenesses if pair.what == 'rates'}
    for pair, alike in evidence.likenesses:
        if pair.what == 'force' and pair.told.split('/')[0] in turning:
            continue  # the rates say it better
        if alike is None:
            unjudged.append(
                f"The clock of '{pair.told}' cannot be judged: '{pair.made}' hardly moves."
            )
        else:
            found += late(pair, alike, evidence.limits)
    return Verdict(tuple(found), tuple(unjudged))


def late(pair: Pair, alike: Likeness, limits: Limits) -> Iterator[Finding]:
    """Yield the lag of a pair, where there is one beyond doubt."""
    own = np.abs(np.diag(alike.correlation))[alike.moving]
    zero = np.abs(alike.at_zero)[alike.moving]
    # The axes that agree best carry the time; a poor one does not take it away.
    best = own >= min(limits.agree, float(own.max()))
    peak = float(own[best].mean())
    if peak < limits.agree:
        return
    found = lags(pair, alike)
    begin, end = pair.span
    shrinks = (1.0 - float(zero[best].mean())) > limits.clock_gain * (1.0 - peak)
    if abs(found.lag) > limits.clock_offset + limits.clock_sigmas * found.error and shrinks:
        word = 'late' if found.lag > 0 else 'early'
        yield Finding(
            KIND, pair.told, begin, end,
            f"{abs(found.lag):.3f} s +- {found.error:.3f} s {word} against '{pair.made}' "
            f'(correlation {peak:.2f}).',
            Severity.SUSPICIOUS, {'lag': found.lag, 'error': found.error},
        )  # fmt: skip
    if abs(found.drift) > limits.clock_offset + limits.clock_sigmas * found.drift_error:
        yield Finding(
            KIND, pair.told, begin, end,
            f"Wanders by {found.drift:.3f} s +- {found.drift_error:.3f} s against '{pair.made}' "
            f'from begin to end.',
            Severity.SUSPICIOUS, {'drift': found.drift, 'error': found.drift_error},
        )  # fmt: skip


def lags(pair: Pair, alike: Likeness) -> Lag:
    """Return the lag of a pair from parts of the flight."""
    left, left_size = deviations(pair.left, pair.known)
    right, right_size = deviations(pair.right, pair.known)
    weight = np.where(alike.moving, 1.0, 0.0) * np.abs(np.diag(alike.correlation)).round(1)
    left = left / np.where(left_size > 0.0, left_size, 1.0) * weight
    right = right / np.where(right_size > 0.0, right_size, 1.0)
    step, moved = pair.step, round(alike.lag / pair.step)
    left = np.roll(left, -moved, axis=0)
    count = int(np.clip(len(left) * step / PART, *PARTS))
    rows, times = [], []
    for part in np.array_split(np.arange(len(left)), count):
        inside = right[part]
        if (inside**2).sum() < 0.1 * (right**2).sum() / count:
            continue  # hardly moves
        near = lag_of(left[part] - left[part].mean(axis=0), inside - inside.mean(axis=0),
                      step, NEAR)  # fmt: skip
        rows.append(moved * step + near)
        times.append(float(pair.grid[part].mean()))
    return summed(np.array(rows), np.array(times), step)


def summed(parts: Array, times: Array, step: float) -> Lag:
    """Return lag and drift of the lags of parts."""
    if len(parts) < 3:
        return Lag(0.0, np.inf, 0.0, np.inf)
    middle = float(np.median(parts))
    spread = NORMAL * float(np.median(np.abs(parts - middle))) + 0.1 * step
    error = MEDIAN * spread / np.sqrt(len(parts))
    if len(parts) < 4:
        return Lag(middle, error, 0.0, np.inf)
    length = float(np.ptp(times))
    slope, offset = np.polyfit(times, parts, 1)
    left = parts - slope * times - offset
    rest = float(np.sqrt((left**2).sum() / (len(parts) - 2))) + 0.1 * step
    drift_error = rest / float(np.sqrt(((times - times.mean()) ** 2).sum())) * length
    return Lag(middle, error, float(slope) * length, drift_error)
