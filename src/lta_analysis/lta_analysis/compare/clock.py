"""
The offset between two clocks that timed the same motion.

Coarse: normalised cross-correlation of the rates of change of several channels at once, over all
lags with enough overlap. Fine: Gauss-Newton on the channels themselves, for offset and drift
together, with a level of each channel in each stretch of ten seconds left free (an estimate that
drifts slowly away says nothing about its clock), outliers held down (Huber), and the uncertainty
from the scatter of whole blocks, so that neighbours that resemble each other count once.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_analysis.compare.line import Array, Line, period, sampled
from lta_analysis.compare.parting import noise
from lta_analysis.compare.spectra import parabola
import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d

STEPS: Final = (0.02, 0.5)  # s; the coarse grid's step is the finest of the channels within these
SMOOTH: Final = 0.15  # s, or two steps
LIVELY: Final = 3.0  # times what noise alone would do to a rate
OVERLAP: Final = 0.3  # of the shorter recording
LIKE: Final = 0.5  # correlation of a channel that is used for the fine step
MOST: Final = 12  # channels of the fine step
LEVEL: Final = 10.0  # s over which a channel's level is free
HUBER: Final = 1.5
RESTING: Final = 0.1  # of the RMS misfit, that the scale of a channel's misfit is at least
BLOCKS: Final = 40
ROUNDS: Final = 30
EXACT: Final = 1e-3  # of a period, for the interpolation
TELLING: Final = 30.0  # s of common time without which drift is not asked for
SURE: Final = 3.0  # standard deviations of a drift that is applied
QUARTZ: Final = 2e-3  # more is no clock's: another pace of the motion
AMBIGUOUS: Final = 0.9  # of the best peak, that a peak elsewhere must stay below
ASIDE: Final = 1.0  # s that another peak lies away at least


class Shared(NamedTuple):
    """One quantity as both flights have it, each on its own clock."""

    name: str
    a: Line
    b: Line
    angular: bool = False


@final
@dataclass(frozen=True, slots=True)
class Offset:
    """
    What B's clock shows more than A's at the same event.

    Attributes
    ----------
    value, sigma : float
        Offset in the middle of the common span, and its standard deviation. [s]
    drift, drift_sigma : float
        Rate at which it grows; applied only where `drifts`. Zero and infinite where the common
        span is too short to tell. [1]
    drifts : bool
        Whether the drift is clear of zero, and such as clocks have.
    middle : float
        The instant of `value` on A's clock. [s]
    correlation : float
        Median correlation of the rates of the channels in `used`, at this offset.
    rival : float
        Height of the highest peak elsewhere, as a share of the best.
    used : tuple of str
        The channels that the fine step rests on.

    """

    value: float
    sigma: float
    drift: float
    drift_sigma: float
    drifts: bool
    middle: float
    correlation: float
    rival: float
    used: tuple[str, ...]

    @property
    def ambiguous(self) -> bool:
        """Whether another offset fits nearly as well, as with a motion that repeats itself."""
        return self.rival > AMBIGUOUS


class Coarse(NamedTuple):
    """Lag, the height of the second peak over the first, and each channel's correlation there."""

    lag: float
    rival: float
    correlations: dict[str, float]


def clock_offset(shared: Sequence[Shared]) -> Offset | None:
    """
    Return the offset between two clocks; None where nothing in the data ties them.

    Parameters
    ----------
    shared : sequence of Shared
        Quantities that do not depend on a world frame.

    """
    found = coarse(shared)
    if found is None:
        return None
    like = {name: value for name, value in found.correlations.items() if value > LIKE}
    names = sorted(like, key=lambda name: -like[name])[:MOST]
    used = [each for each in shared if each.name in names]
    return fine(used, found, float(np.median([like[name] for name in names]))) if used else None


def coarse(shared: Sequence[Shared]) -> Coarse | None:
    """Return the lag at which the rates of change of all channels resemble each other most."""
    able = [each for each in shared if len(each.a.time) > 8 and len(each.b.time) > 8]
    if not able:
        return None
    slower = [max(period(each.a.time), period(each.b.time)) for each in able]
    step = float(np.clip(min(slower), *STEPS))
    begins = [min(float(side(each).time[0]) for each in able) for side in (_a, _b)]
    counts = [
        1 + math.ceil((max(float(side(each).time[-1]) for each in able) - begin) / step)
        for side, begin in zip((_a, _b), begins, strict=True)
    ]
    least = OVERLAP * min(counts)
    size = 1 << (sum(counts) - 1).bit_length()
    scores: dict[str, Array] = {}
    share = np.zeros(size)
    for each in able:
        rates = [
            rate(side(each), begin, step, count, each.angular)
            for side, begin, count in zip((_a, _b), begins, counts, strict=True)
        ]
        if rates[0] is not None and rates[1] is not None:
            likeness, common = correlated(rates[0], rates[1], size, least)
            scores[each.name] = likeness
            share = np.maximum(share, common / min(counts))
    if not scores:
        return None
    total = np.mean(list(scores.values()), axis=0) * np.minimum(share, 1.0) ** 0.25
    best = int(total.argmax())
    if total[best] <= 0.0:
        return None
    lags = np.where(np.arange(size) < counts[1], np.arange(size), np.arange(size) - size)
    elsewhere = total[np.abs(lags - lags[best]) * step > ASIDE]
    rival = max(0.0, float(elsewhere.max())) / float(total[best]) if len(elsewhere) else 0.0
    shift, _ = parabola(np.roll(total, size // 2 - best), size // 2)
    lag = (float(lags[best]) + shift) * step + begins[1] - begins[0]
    return Coarse(lag, rival, {name: float(score[best]) for name, score in scores.items()})


def _a(each: Shared) -> Line:
    """Return the quantity as A has it."""
    return each.a


def _b(each: Shared) -> Line:
    """Return the quantity as B has it."""
    return each.b


def straight(line: Line, angular: bool) -> Line:
    """Return what is known of a line, angles without jumps."""
    known = np.isfinite(line.values)
    values = line.values[known]
    return Line(line.time[known], np.unwrap(values) if angular else values)


def rate(line: Line, begin: float, step: float, count: int, angular: bool) -> Array | None:
    """Return a line's smoothed rate of change on a grid; None where noise alone would do that."""
    values = sampled(straight(line, angular), begin + step * np.arange(count))
    known = np.isfinite(values)
    if known.sum() < 8:
        return None
    instants = np.arange(count)
    held = np.interp(instants, instants[known], values[known])
    width = max(SMOOTH, 2.0 * step)
    found = gaussian_filter1d(held, width / step, order=1) / step
    found[~known] = np.nan
    # White noise through the derivative of a Gaussian: variance h / (4 sqrt(pi) w^3).
    usual = max(period(line.time), step)
    alone = noise(line.values) * math.sqrt(usual / (4.0 * math.sqrt(math.pi) * width**3))
    size = math.sqrt(float(np.nanmean(found**2)))
    return found if size > max(LIVELY * alone, 1e-12) else None


def correlated(a: Array, b: Array, size: int, least: float) -> tuple[Array, Array]:
    """
    Return the correlation of two rates at each circular lag of b, and how much overlaps there.

    At each lag only what both know counts (Padfield 2012, "Masked object registration in the
    Fourier domain", without taking off the mean, since a rate is near zero at rest).
    """
    parts = []
    for values in (a, b):
        known = np.isfinite(values)
        zeroed = np.where(known, values, 0.0)
        parts.append([np.fft.rfft(part, size) for part in (zeroed, zeroed**2, known * 1.0)])
    (va, ea, ma), (vb, eb, mb) = parts
    product = np.fft.irfft(np.conj(va) * vb, size)
    energy_a = np.fft.irfft(np.conj(ea) * mb, size)
    energy_b = np.fft.irfft(np.conj(ma) * eb, size)
    common = np.fft.irfft(np.conj(ma) * mb, size)
    floor = 1e-6 * (np.nansum(a**2) * np.nansum(b**2)) ** 0.5
    power = np.sqrt(np.maximum(energy_a, 0.0) * np.maximum(energy_b, 0.0))
    usable = (common >= least) & (power > floor)
    return np.where(usable, product / np.where(usable, power, 1.0), 0.0), np.where(
        usable, common, 0.0
    )


class Prepared(NamedTuple):
    """One channel for the fine step: A smoothed at even instants, B as a smooth curve."""

    time: Array
    a: Array
    known: Line
    b: CubicSpline


def prepared(each: Shared) -> Prepared:
    """Return a channel ready to be shifted, both sides smoothed alike."""
    lines = [straight(side(each), each.angular) for side in (_a, _b)]
    periods = [period(line.time) for line in lines]
    step, width = min(periods), 1.5 * max(periods)
    found = []
    for line in lines:
        count = 2 + int((line.time[-1] - line.time[0]) / step)
        grid = line.time[0] + step * np.arange(count)
        seen = sampled(line, grid)
        smooth = gaussian_filter1d(np.interp(grid, line.time, line.values), width / step)
        found.append((grid, smooth, seen))
    (grid, a, seen), (grid_b, b, seen_b) = found
    inner = np.isfinite(seen)
    return Prepared(grid[inner], a[inner], Line(grid_b, seen_b), CubicSpline(grid_b, b))


def fine(used: Sequence[Shared], start: Coarse, correlation: float) -> Offset:
    """Return the offset and drift of least misfit, with their uncertainty."""
    channels = [prepared(each) for each in used]
    shift = start.lag
    begin = min(float(each.time[0]) for each in channels)
    end = max(float(each.time[-1]) for each in channels)
    begin = max(begin, min(float(each.known.time[0]) for each in channels) - shift)
    end = min(end, max(float(each.known.time[-1]) for each in channels) - shift)
    middle, span = 0.5 * (begin + end), end - begin
    step = min(period(each.time) for each in channels)
    both = settled(channels, np.array([shift, 0.0]), middle, span, step, 2)
    telling = span >= TELLING
    deviation = math.sqrt(both.covariance[1, 1]) if telling else math.inf
    drifts = telling and SURE * deviation < abs(float(both.values[1])) < QUARTZ
    single = both if drifts else settled(channels, np.array([shift, 0.0]), middle, span, step, 1)
    return Offset(
        value=float(single.values[0]),
        sigma=math.hypot(math.sqrt(single.covariance[0, 0]), EXACT * step),
        drift=float(both.values[1]) if telling else 0.0,
        drift_sigma=deviation,
        drifts=drifts,
        middle=middle,
        correlation=correlation,
        rival=start.rival,
        used=tuple(each.name for each in used),
    )


class Settled(NamedTuple):
    """Offset and drift, and their covariance, shape (2, 2)."""

    values: Array
    covariance: Array


def settled(
    channels: Sequence[Prepared], at: Array, middle: float, span: float, step: float, free: int
) -> Settled:
    """Return the offset, and the drift where two numbers are free, by Gauss-Newton."""
    edges = np.linspace(middle - span / 2, middle + span / 2, BLOCKS + 1)[1:-1]
    for _ in range(ROUNDS):
        normal, blocks = np.zeros((free, free)), np.zeros((BLOCKS, free))
        for each in channels:
            one, scores = scored(each, at, middle, edges, free)
            normal += one
            blocks += scores
        if np.linalg.matrix_rank(normal) != free:
            break
        change = np.linalg.solve(normal, blocks.sum(axis=0))
        at = at + np.pad(change, (0, 2 - free))
        if abs(change[0]) < 1e-7 * step:
            break
    covariance = np.full((2, 2), math.inf)
    if np.linalg.matrix_rank(normal) == free:
        inverse = np.linalg.inv(normal)
        spread = blocks.T @ blocks * (BLOCKS / (BLOCKS - free))
        covariance[:free, :free] = inverse @ spread @ inverse
    return Settled(at, covariance)


def scored(
    each: Prepared, at: Array, middle: float, edges: Array, free: int
) -> tuple[Array, Array]:
    """Return one channel's normal matrix, and its pull on the numbers in each block."""
    moved = each.time + at[0] + at[1] * (each.time - middle)
    known = np.isfinite(sampled(each.known, moved))
    time, moved = each.time[known], moved[known]
    if len(time) < 8:
        return np.zeros((free, free)), np.zeros((BLOCKS, free))
    stretch = ((time - time[0]) // LEVEL).astype(int)
    misfit = levelled(each.a[known] - each.b(moved), stretch)
    slope = levelled(each.b(moved, 1), stretch)
    scale = 1.4826 * float(np.median(np.abs(misfit)))
    # A channel that rests for most of the time has a median of zero, and is not perfect for that.
    scale = max(scale, RESTING * math.sqrt(float(np.mean(misfit**2))))
    scale = max(scale, 1e-9 * float(np.ptp(each.a[known])), 1e-150)
    size = np.abs(misfit) / scale
    weight = np.where(size > HUBER, HUBER / np.maximum(size, HUBER), 1.0) / scale**2
    slopes = np.stack([slope, slope * (time - middle)][:free], axis=1)
    pulls = slopes * (weight * misfit)[:, None]
    index = np.searchsorted(edges, time)
    blocks = np.stack([np.bincount(index, pull, BLOCKS) for pull in pulls.T], axis=1)
    return slopes.T @ (slopes * weight[:, None]), blocks


def levelled(values: Array, stretch: np.ndarray) -> Array:
    """Return values less their mean in each stretch."""
    counts = np.maximum(np.bincount(stretch), 1)
    means = np.bincount(stretch, values) / counts
    return np.asarray(values - means[stretch])
