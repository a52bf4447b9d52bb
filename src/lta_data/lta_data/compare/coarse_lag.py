# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find about how far two flights are apart in time: by the lag of highest correlation, or by starts.

The correlation is that of the rates of change of many channels; separate runs of one plan are laid
on each other where they start to move.
"""

from collections.abc import Sequence
import math
from typing import Final, NamedTuple

from lta_data.compare.divergence import (
    compute_later_share,
    noise_deviation,
    white_noise_deviation,
)
from lta_data.compare.sampling import Array, interpolate_signal
from lta_data.even_grid import check_time_span, median_period, SampledSignal
from lta_data.interpretation.commands import is_command_topic
import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import correlate, correlation_lags

LAG_STEPS: Final = (0.02, 0.5)  # s; limits of the grid step, which follows the fastest channel
RATE_SMOOTHING: Final = 0.15  # s of smoothing, or two steps if longer
LIVELY_RATIO: Final = 3.0  # least ratio of a rate's RMS to that of noise alone
OVERLAP: Final = 0.3  # least overlap, of the shorter recording
SECOND_PEAK_DISTANCE: Final = 1.0  # s; least distance of a second peak


class SharedQuantity(NamedTuple):
    """One quantity of both flights, each on its own clock."""

    name: str
    a: SampledSignal
    b: SampledSignal
    angular: bool = False


class CoarseLag(NamedTuple):
    """Lag [s], height of the second peak over the first, and the correlation of each channel."""

    lag: float
    rival: float
    correlations: dict[str, float]


def estimate_coarse_lag(
    shared: Sequence[SharedQuantity], search: float = math.inf
) -> CoarseLag | None:
    """
    Return the lag at which the rates of change correlate best; None if none do.

    `search`: largest lag of a sensor [s]; unlimited between flights.

    Raise `BadInput` if the time stamps of a flight span too long for their number.
    """
    able = [each for each in shared if len(each.a.time) > 8 and len(each.b.time) > 8]
    if not able:
        return None
    slower = [max(median_period(each.a.time), median_period(each.b.time)) for each in able]
    # Finer than the slower side of any channel gains nothing.
    step = float(np.clip(min(slower), *LAG_STEPS))
    begins = [min(float(both_signals(each)[k].time[0]) for each in able) for k in (0, 1)]
    ends = [max(float(both_signals(each)[k].time[-1]) for each in able) for k in (0, 1)]
    for k, label in enumerate('AB'):
        most = max(len(both_signals(each)[k].time) for each in able)
        check_time_span(f'of {label}', ends[k] - begins[k], step, most)
    counts = [1 + math.ceil((ends[k] - begins[k]) / step) for k in (0, 1)]
    scores: dict[str, Array] = {}
    # In grid steps, of B behind A where both grids begin at once
    lags = correlation_lags(counts[1], counts[0])
    share = np.zeros(len(lags))
    for each in able:
        of_a, of_b = (
            smoothed_rate(both_signals(each)[k], begins[k], step, counts[k], each.angular)
            for k in (0, 1)
        )
        if of_a is not None and of_b is not None:
            scores[each.name], common = correlate_rates(of_a, of_b, OVERLAP * min(counts))
            # Largest overlap of any channel at each lag
            share = np.maximum(share, common / min(counts))
    if not scores:
        return None
    # The fourth root favours long overlaps only mildly.
    total = np.mean(list(scores.values()), axis=0) * np.minimum(share, 1.0) ** 0.25
    within = np.abs(lags * step + begins[1] - begins[0]) <= search
    best = int(np.where(within, total, 0.0).argmax())
    if total[best] <= 0.0 or not within[best]:
        return None
    # Near the peak, lags belong to it; a sensor can have the wrong sign, so opposite peaks count
    rivals = total if math.isinf(search) else np.abs(total)
    elsewhere = rivals[within & (np.abs(lags - lags[best]) * step > SECOND_PEAK_DISTANCE)]
    rival = max(0.0, float(elsewhere.max())) / float(total[best]) if len(elsewhere) else 0.0
    # The grids start at each flight's own time
    lag = (float(lags[best]) + find_peak_shift(total, best)) * step + begins[1] - begins[0]
    return CoarseLag(lag, rival, {name: float(score[best]) for name, score in scores.items()})


def find_peak_shift(values: Array, best: int) -> float:
    """Return the position, relative to `best`, of the peak of evenly spaced values."""
    if not 0 < best < len(values) - 1:
        return 0.0
    before, here, after = (float(value) for value in values[best - 1 : best + 2])
    bend = before - 2.0 * here + after
    # Not a maximum: a parabola has no peak here.
    return 0.5 * (before - after) / bend if bend < 0.0 else 0.0


def both_signals(each: SharedQuantity) -> tuple[SampledSignal, SampledSignal]:
    """Return A's and B's signal."""
    return each.a, each.b


def unwrap_finite(line: SampledSignal, angular: bool) -> SampledSignal:
    """Return the finite samples of a signal, angles unwrapped."""
    time, values = line.select_complete()
    return SampledSignal(time, np.unwrap(values) if angular else values)


def smoothed_rate(
    line: SampledSignal, begin: float, step: float, count: int, angular: bool
) -> Array | None:
    """Return the smoothed rate of a signal on a grid, per second; None if it is only noise."""
    grid = np.asarray(begin + step * np.arange(count), dtype=np.float64)
    values = interpolate_signal(unwrap_finite(line, angular), grid)
    finite = np.isfinite(values)
    if finite.sum() < 8:
        return None
    instants = np.arange(count)
    # The filter needs values in the gaps; they become NaN again below.
    held = np.interp(instants, instants[finite], values[finite])
    width = max(RATE_SMOOTHING, 2.0 * step)
    rate = gaussian_filter1d(held, width / step, order=1) / step
    rate[~finite] = np.nan
    # White noise after the derivative of a Gaussian: variance h / (4 sqrt(pi) w^3).
    usual = max(median_period(line.time), step)
    alone = noise_deviation(line.values) * math.sqrt(usual / (4.0 * math.sqrt(math.pi) * width**3))
    size = math.sqrt(float(np.nanmean(rate**2)))
    return rate if size > max(LIVELY_RATIO * alone, 1e-12) else None


def correlate_rates(a: Array, b: Array, least: float) -> tuple[Array, Array]:
    """
    Return the correlation of two rates at each lag of b, and the overlap there.

    At each lag only samples known in both count (Padfield 2012, "Masked object registration in
    the Fourier domain"). The mean is not subtracted, because a rate is near zero at rest.
    """
    (va, ma), (vb, mb) = (
        (np.nan_to_num(values), np.isfinite(values).astype(np.float64)) for values in (a, b)
    )
    product, energy_a, energy_b, common = (
        correlate(one, other, method='fft')
        for one, other in ((vb, va), (mb, va**2), (vb**2, ma), (mb, ma))
    )
    # Rounding noise of the FFT must not pass as a correlation.
    floor = 1e-6 * float(np.linalg.norm(va) * np.linalg.norm(vb))
    power = np.sqrt(np.maximum(energy_a, 0.0) * np.maximum(energy_b, 0.0))
    usable = (common >= least) & (power > floor)
    return np.where(usable, product / np.where(usable, power, 1.0), 0.0), np.where(
        usable, common, 0.0
    )


REST_TIME: Final = 0.3  # s of rest needed before a start
START_DEVIATIONS: Final = 8.0  # least deviation from rest, in noise deviations
START_SHARE: Final = 0.02  # least deviation from rest, of the channel's range
MIN_START_CHANNELS: Final = 3  # channels of motion needed for a start and its uncertainty
CREEP: Final = 0.5  # of the limit; largest drift of a channel at rest


class StartOffset(NamedTuple):
    """B's start minus A's and its standard deviation [s]; channels used; whether commands."""

    offset: float
    sigma: float
    used: tuple[str, ...]
    by_command: bool


def find_motion_start(line: SampledSignal, angular: bool = False) -> float | None:
    """Return when a channel first leaves its initial level; None if it never rested [s]."""
    time, values = unwrap_finite(line, angular)
    if len(time) < 8 or np.ptp(values) == 0.0:
        return None
    step = median_period(time)
    # At least four samples, for the median of slow channels
    first = time < time[0] + max(REST_TIME, 4.0 * step)
    level = float(np.median(values[first]))
    low, high = np.percentile(values, [2.0, 98.0])
    # The range excludes outliers: 2 % on either side.
    limit = max(START_DEVIATIONS * white_noise_deviation(values), START_SHARE * float(high - low))
    away = np.abs(values - level) > limit
    # Three quarters of the window must be away, so that a single outlier is no start.
    lasting = away & (compute_later_share(time, away, max(REST_TIME, 4.0 * step)) >= 0.75)
    # A channel that drifts from the beginning was moving already
    creep = abs(float(values[first][-1] - values[first][0]))
    if not lasting.any() or creep > CREEP * limit:
        return None
    return float(time[lasting.argmax()])


def estimate_start_offset(shared: Sequence[SharedQuantity]) -> StartOffset | None:
    """
    Return the offset between the starts of two flights; None without a common start.

    Commands are used if they start, otherwise the motion, if enough channels show it. The offset
    is the median over the channels; its uncertainty comes from their scatter and periods.
    """
    # Commands start sharply; motion follows with a delay of its own.
    for by_command in (True, False):
        instants = {}
        for each in shared:
            topic = each.name.rpartition('/')[0]
            if is_command_topic(topic) is by_command:
                starts = (
                    find_motion_start(each.a, each.angular),
                    find_motion_start(each.b, each.angular),
                )
                if starts[0] is not None and starts[1] is not None:
                    # Both starts are known to one period of their own recording
                    step = math.hypot(median_period(each.a.time), median_period(each.b.time))
                    instants[each.name] = starts[1] - starts[0], step
        if len(instants) >= (1 if by_command else MIN_START_CHANNELS):
            offsets = np.array([offset for offset, _ in instants.values()])
            middle = float(np.median(offsets))
            scatter = 1.4826 * float(np.median(np.abs(offsets - middle))) / math.sqrt(len(offsets))
            # Sampling makes a start uncertain by a uniform distribution of one period.
            step = min(step for _, step in instants.values()) / math.sqrt(12.0)
            return StartOffset(middle, math.hypot(scatter, step), tuple(instants), by_command)
    return None
