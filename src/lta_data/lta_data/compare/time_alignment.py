# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Map B's time to A's: by the common clock, by the start of motion, by a given offset, or not."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final, Literal

from lta_config.errors import BadInput
from lta_data.compare.channel_comparison import ChannelPair
from lta_data.compare.clock_offset import ClockOffset, estimate_clock_offset
from lta_data.compare.coarse_lag import estimate_start_offset, SharedQuantity
from lta_data.compare.sampling import Array, interpolate_signal
from lta_data.even_grid import NO_SAMPLES, SampledSignal
from lta_data.flight import Flight
from lta_data.importers.log_provenance import have_separate_clocks
import numpy as np

Align = Literal['auto', 'clock', 'motion', 'none']
SAME_RUN: Final = 0.9  # least correlation of the rates of one run recorded twice
SAME_COUNT: Final = 0.98  # the same for two logs without a clock: repeated runs reach 0.961
TELLING_DEVIATIONS: Final = 3  # standard deviations from which an offset is mentioned
PLACE_FIELDS: Final = ('position.x', 'position.y')


@final
@dataclass(frozen=True, slots=True)
class TimeAlignment:
    """Mapping of B's time to A's."""

    how: str  # 'clock', 'motion', 'given' or 'none'
    reason: str  # one sentence
    # Whether offsets refer to the clocks of the stamps; otherwise to the times since each flight's
    # start, because the stamps do not overlap
    on_stamps: bool
    lead: float  # A's start minus B's, on the clock of the stamps; zero if not `on_stamps` [s]
    # Reading of B's clock minus A's at the same event, and its standard deviation [s]
    offset: float = 0.0
    sigma: float = 0.0
    drift: float = 0.0  # applied rate of growth of the offset [1]
    middle: float = 0.0  # time of `offset` on A's clock [s]
    estimated_offset: ClockOffset | None = None  # offset estimated from the data, applied or not
    used: tuple[str, ...] = ()  # channels from which the offset was estimated
    remarks: tuple[str, ...] = ()  # further remarks for the user

    def convert_to_a_time(self, time: Array) -> Array:
        """Convert times of B, since its start, to times since A's start [s]."""
        # Inverse of: time of B = t + lead + offset + drift * (t - middle)
        shifted = time - self.lead - self.offset + self.drift * self.middle
        return np.asarray(shifted / (1.0 + self.drift))


def align_times(
    a: Flight,
    b: Flight,
    pairs: Sequence[ChannelPair],
    align: Align = 'auto',
    manual_offset: float | None = None,
) -> TimeAlignment:
    """
    Determine how to map B's time to A's.

    `align` is 'clock': one run timed by two clocks, whose offset is estimated; 'motion': separate
    runs, aligned at their starts; 'none': the stamps unchanged; 'auto': decided by the data.
    `manual_offset` [s] overrides it.

    Raise `BadInput` if the requested alignment cannot be determined from the data.
    """
    bare = align_by_stamps(a, b)
    if manual_offset is not None:
        return replace(
            bare, how='given', offset=manual_offset, reason='The offset was set by hand.'
        )
    if align == 'none':
        return replace(bare, reason='As requested with --align.')
    # Counted rows and times from zero overlap without sharing a clock.
    if have_separate_clocks(a.provenance, b.provenance):
        bare = replace(bare, on_stamps=False, lead=0.0)
    shared = select_frame_invariants(pairs, bare)
    if align == 'motion':
        return align_by_start(bare, shared, 'As requested with --align.')
    offset = estimate_clock_offset(shared)
    bare = replace(bare, estimated_offset=offset)
    if align == 'clock':
        if offset is None:
            raise BadInput(
                'No common channel correlates between the flights, so the offset of their clocks '
                'cannot be estimated; give --offset, or use --align none.'
            )
        return align_by_clock(bare, offset, 'As requested with --align.')
    return choose_alignment(a, b, pairs, bare, shared)


def choose_alignment(
    a: Flight,
    b: Flight,
    pairs: Sequence[ChannelPair],
    bare: TimeAlignment,
    shared: Sequence[SharedQuantity],
) -> TimeAlignment:
    """Choose the alignment from the data."""
    offset = bare.estimated_offset
    if bare.on_stamps and have_same_stamps(a, b, pairs):
        reason = 'Both flights have the same time stamps, so no offset is applied.'
        return replace(bare, reason=reason, remarks=describe_suspected_offset(offset))
    counted = have_separate_clocks(a.provenance, b.provenance)
    # Times counted from zero carry no evidence of one run, so require a higher correlation
    if offset is not None and offset.correlation >= (SAME_COUNT if counted else SAME_RUN):
        reason = (
            f'At this offset, A and B change at the same rates (correlation '
            f'{offset.correlation:.2f}), so both are recordings of the same run.'
        )
        return align_by_clock(bare, offset, reason)
    if bare.on_stamps:
        reason = (
            'The time stamps of the two recordings overlap and are used unchanged: the data '
            'show no clear offset.'
        )
        return replace(bare, reason=reason)
    try:
        reason = (
            'The time stamps do not overlap and the motions differ, so A and B are separate runs.'
        )
        return align_by_start(bare, shared, reason)
    except BadInput:
        reason = (
            'The time stamps do not overlap, and no start of motion or commands was found that '
            'both flights have.'
        )
        return replace(bare, reason=reason, remarks=describe_suspected_offset(offset))


def align_by_stamps(a: Flight, b: Flight) -> TimeAlignment:
    """Return the alignment by stamps, or by each flight's start if the stamps do not overlap."""
    # ns to s
    lead = (a.start - b.start) * 1e-9
    (begin_a, end_a), (begin_b, end_b) = a.span, b.span
    overlap = min(end_a, end_b - lead) - max(begin_a, begin_b - lead)
    on_stamps = overlap > 0.0
    return TimeAlignment('none', '', on_stamps, lead if on_stamps else 0.0)


def have_same_stamps(a: Flight, b: Flight, pairs: Sequence[ChannelPair]) -> bool:
    """Return whether the flights start at the same stamp and share most stamps exactly."""
    if a.start != b.start:
        return False
    shared = total = 0
    # All channels of a topic have the same stamps, so one pair per topic suffices
    times = {(pair.a.topic, pair.b.topic): (pair.a.time, pair.b.time) for pair in pairs}
    for both in times.values():
        # Whole nanoseconds: float seconds of equal stamps may differ by rounding
        one, other = (np.unique(np.rint(time * 1e9).astype(np.int64)) for time in both)
        shared += len(np.intersect1d(one, other, assume_unique=True))
        total += min(len(one), len(other))
    # Half of the stamps, since recordings may start and drop messages separately.
    return total > 0 and 2 * shared >= total


def align_by_clock(bare: TimeAlignment, estimate: ClockOffset, reason: str) -> TimeAlignment:
    """Return the alignment with the estimated offset applied."""
    remarks = []
    if estimate.is_ambiguous:
        remarks.append(
            'Another clock offset fits nearly as well, because the motion is periodic; check the '
            'estimated offset, and correct it with --offset if needed.'
        )
    return replace(
        bare, how='clock', reason=reason, offset=estimate.value, sigma=estimate.sigma,
        drift=estimate.drift if estimate.drifts else 0.0, middle=estimate.middle,
        estimated_offset=estimate, used=estimate.used, remarks=tuple(remarks),
    )  # fmt: skip


def align_by_start(
    bare: TimeAlignment, shared: Sequence[SharedQuantity], reason: str
) -> TimeAlignment:
    """Align the starts of both flights; raise `BadInput` if there is no common start."""
    start = estimate_start_offset(shared)
    if start is None:
        raise BadInput(
            'No start of motion or commands was found in both flights, so their starts cannot be '
            'aligned; give the offset of their clocks with --offset, or use --align none.'
        )
    what = 'commands' if start.by_command else 'motion'
    return replace(
        bare, how='motion', reason=f'{reason} The flights are aligned at the start of the {what}.',
        offset=start.offset, sigma=start.sigma, used=start.used,
    )  # fmt: skip


def describe_suspected_offset(estimate: ClockOffset | None) -> tuple[str, ...]:
    """Return a remark if the data fit clearly better with an offset other than zero."""
    if estimate is None or estimate.correlation < SAME_RUN or estimate.is_ambiguous:
        return ()
    # Offsets below 1 ms are irrelevant.
    if abs(estimate.value) <= max(TELLING_DEVIATIONS * estimate.sigma, 1e-3):
        return ()
    return (
        f'The motions agree best at an offset of {1e3 * estimate.value:+.1f} ms (standard '
        f'deviation {1e3 * estimate.sigma:.1f} ms): a lag of one flight or of its clock. Remove '
        'it with --align clock.',
    )


def select_frame_invariants(
    pairs: Sequence[ChannelPair], bare: TimeAlignment
) -> list[SharedQuantity]:
    """
    Return the shared quantities that do not depend on a world frame.

    Positions are replaced by ground speed.
    """
    invariants = []
    for pair in pairs:
        a, b = pair.signals
        b = b._replace(time=b.time - bare.lead)
        # Horizontal positions depend on the world frame; their speed does not.
        if not pair.name.endswith(PLACE_FIELDS):
            invariants.append(SharedQuantity(pair.name, a, b, pair.angular))
    by_name = {pair.name: pair for pair in pairs}
    for name, pair in by_name.items():
        other = by_name.get(name.removesuffix(PLACE_FIELDS[0]) + PLACE_FIELDS[1])
        if name.endswith(PLACE_FIELDS[0]) and other is not None:
            a, b = (
                ground_speed(*sides) for sides in zip(pair.signals, other.signals, strict=True)
            )
            b = b._replace(time=b.time - bare.lead)
            invariants.append(SharedQuantity(f'{name.removesuffix(".x")}.way', a, b))
    return invariants


def ground_speed(of_x: SampledSignal, of_y: SampledSignal) -> SampledSignal:
    """Return the horizontal speed, from positions smoothed over 0.25 s [m/s]."""
    if len(of_x.time) < 8 or len(of_y.time) != len(of_x.time):
        return SampledSignal(NO_SAMPLES, NO_SAMPLES)
    step = max(0.05, float(np.median(np.diff(of_x.time))))
    half = 2.5 * step
    # The window must fit into the recording
    inner = of_x.time[(of_x.time >= of_x.time[0] + half) & (of_x.time <= of_x.time[-1] - half)]
    # Six points over five steps: a smooth derivative at any message rate.
    lags = np.linspace(-half, half, 6)
    rates = []
    for line in (of_x, of_y):
        near = np.stack([interpolate_signal(line, inner + lag) for lag in lags])
        # Least-squares slope of six values over the window.
        rates.append(lags @ near / float(lags @ lags))
    return SampledSignal(inner, np.hypot(*rates))
