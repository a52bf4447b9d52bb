"""Compare one channel of two flights: size, spectrum and time of the difference."""

from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Final, final

from lta_config.errors import BadInput
from lta_data.compare.channel_pairs import ChannelPair
from lta_data.compare.divergence import Divergence, find_divergence, noise_band
from lta_data.compare.measures import DifferenceMeasures, measure_difference, standard_deviation
from lta_data.compare.sampling import (
    align_signals,
    AlignedSignals,
    median_period,
    SampledSignal,
    sort_samples,
)
from lta_data.compare.spectra import (
    ChannelSpectra,
    compute_spectra,
    CorrelationPeak,
    find_correlation_peak,
)
import numpy as np

STRAY: Final = 0.01  # share of samples that noise alone may put outside the band


@final
@dataclass(frozen=True, slots=True)
class ChannelComparison:
    """One channel of both flights."""

    # The channel's name in A and in B
    name: str
    other: str
    unit: str  # unit of the values
    angular: bool  # whether values 2 pi apart are equal
    # 'parted': outside the band to the end. 'apart at times': outside it for longer than a moment,
    # or at more than 1 % of the samples. 'together'. 'identical': all times and values are equal.
    # 'unknown': no common valid sample
    verdict: str
    # Both as recorded, on A's time, B in A's frame
    a: SampledSignal
    b: SampledSignal
    both: AlignedSignals  # both at the same times
    periods: tuple[float, float]  # median periods of A and B [s]
    measures: DifferenceMeasures | None  # None if there is no common valid sample
    parting: Divergence  # when they differ
    spectra: ChannelSpectra | None  # None if there are too few consecutive samples
    peak: CorrelationPeak | None  # None if one side is constant
    # Rank of the divergence: RMS over the larger of both spreads and the band, times the share of
    # the common span during which they differ.
    score: float

    @property
    def both_constant(self) -> bool:
        """Whether both sides are constant."""
        return all(
            not np.isfinite(line.values).any() or np.nanmax(line.values) == np.nanmin(line.values)
            for line in (self.a, self.b)
        )


def compare_channels(
    pair: ChannelPair,
    a: SampledSignal,
    b: SampledSignal,
    *,
    tolerance: float | None = None,
    doubt: float = 0.0,
) -> ChannelComparison:
    """
    Compare two channels that are both on A's time.

    `tolerance` replaces the noise band [unit of the channel]; `doubt` is the standard deviation
    of the clock offset [s].
    """
    angular = pair.angular
    both = align_signals(a, b, angular=angular)
    measures = measure_difference(both, angular=angular)
    by_hand = tolerance is not None
    band = noise_band(both, angular=angular, doubt=doubt) if tolerance is None else tolerance
    when = find_divergence(both, band, by_hand=by_hand)
    same = np.array_equal(a.time, b.time) and np.array_equal(a.values, b.values, equal_nan=True)
    return ChannelComparison(
        name=pair.name,
        other=pair.b.name,
        unit=pair.a.unit or pair.b.unit,
        angular=angular,
        verdict='identical' if same and len(a.time) else classify_difference(measures, when),
        a=a,
        b=b,
        both=both,
        periods=(median_period(a.time), median_period(b.time)),
        measures=measures,
        parting=when,
        spectra=compute_spectra(both, angular=angular),
        peak=find_correlation_peak(both, angular=angular),
        score=0.0 if measures is None else score_difference(both, measures, when, angular),
    )


def classify_difference(difference: DifferenceMeasures | None, when: Divergence) -> str:
    """Return the verdict on a channel that is not identical."""
    if difference is None:
        return 'unknown'
    if when.at is not None:
        return 'parted'
    strayed = when.outside > (0.0 if when.given else STRAY)
    return 'apart at times' if strayed or when.first is not None else 'together'


def score_difference(
    both: AlignedSignals, difference: DifferenceMeasures, when: Divergence, angular: bool
) -> float:
    """Return the rank of a divergence by its size and duration. [1]"""
    valid = both.both_valid
    spread = max(standard_deviation(part[valid], angular) for part in (both.a, both.b))
    # The band limits the score of a nearly constant channel.
    scale = max(spread, when.band)
    size = difference.rms / scale if scale > 0.0 else float(difference.rms > 0.0)
    if when.at is None:
        return size * when.outside
    time = both.time[valid]
    length = float(time[-1] - time[0])
    # The earlier the divergence, the larger the share of the span.
    return size * (float(time[-1]) - when.at) / length if length > 0.0 else size


def build_pair_signals(pair: ChannelPair) -> tuple[SampledSignal, SampledSignal]:
    """Return both channels of a pair, sorted by time."""
    return sort_samples(pair.a.time, pair.a.values), sort_samples(pair.b.time, pair.b.values)


def find_channel_tolerances(texts: Mapping[str, float], names: list[str]) -> dict[str, float]:
    """
    Return the tolerance of each channel that has one.

    The keys of `texts` are names or patterns such as 'odom/*position*'; the first match applies.

    Raise `BadInput` if a name or pattern matches no channel.
    """
    tolerances: dict[str, float] = {}
    for pattern, value in texts.items():
        fitting = [name for name in names if name == pattern or fnmatchcase(name, pattern)]
        if not fitting:
            raise BadInput(
                f"--tolerance: no channel of both flights matches '{pattern}'; run without "
                '--tolerance to list the channels.'
            )
        for name in fitting:
            tolerances.setdefault(name, value)
    return tolerances
