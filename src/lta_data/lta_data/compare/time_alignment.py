"""How B's time is laid on A's: by a common clock, by the start of motion, as given, or not."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final, Literal

from lta_config.errors import BadInput
from lta_data.compare.channel_pairs import ChannelPair
from lta_data.compare.clock_offset import ClockOffset, estimate_clock_offset
from lta_data.compare.coarse_lag import SharedQuantity
from lta_data.compare.compared_flight import ComparedFlight
from lta_data.compare.motion_start import find_common_start
from lta_data.compare.sampling import Array, interpolate_signal, SampledSignal, sort_samples
from lta_data.importers.clocks import have_own_clocks
import numpy as np

Align = Literal['auto', 'clock', 'motion', 'none']
SAME_RUN: Final = 0.9  # correlation of rates that one run recorded twice has, and two runs do not
SAME_COUNT: Final = 0.98  # the same of logs that are both without a clock: repeats reach 0.961
TELLING: Final = 3  # deviations of an offset that is remarked on
PLACES: Final = ('position.x', 'position.y')


@final
@dataclass(frozen=True, slots=True)
class TimeAlignment:
    """
    Where B's time lies on A's.

    Attributes
    ----------
    how : str
        'clock', 'motion', 'given' or 'none'.
    reason : str
        Why, in a sentence.
    on_stamps : bool
        Whether offsets count between the clocks of the stamps; else between the times since each
        flight's own start, because the clocks have nothing in common.
    lead : float
        A's start after B's, on the clock of the stamps; zero where they do not count. [s]
    offset, sigma : float
        What B's clock shows more than A's at the same event, and its standard deviation. [s]
    drift : float
        What the offset grows by, in s a second, as applied.
    middle : float
        The instant of `offset` on A's time. [s]
    found : Offset or None
        What the data say of the clocks, whether applied or not.
    used : tuple of str
        Channels that the offset rests on.
    remarks : tuple of str
        What else a reader should know.

    """

    how: str
    reason: str
    on_stamps: bool
    lead: float
    offset: float = 0.0
    sigma: float = 0.0
    drift: float = 0.0
    middle: float = 0.0
    found: ClockOffset | None = None
    used: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    def map_to_a(self, time: Array) -> Array:
        """Return times of B, since its start, as times since A's start. [s]"""
        shifted = time - self.lead - self.offset + self.drift * self.middle
        return np.asarray(shifted / (1.0 + self.drift))


def align_times(
    a: ComparedFlight,
    b: ComparedFlight,
    pairs: Sequence[ChannelPair],
    align: Align = 'auto',
    manual_offset: float | None = None,
) -> TimeAlignment:
    """
    Return how to lay B's time on A's.

    Parameters
    ----------
    a, b : Side
        The flights.
    pairs : sequence of Pair
        What both have.
    align : str
        'clock': the same run, timed by two clocks; the offset is estimated. 'motion': separate
        runs; their starts are laid on each other. 'none': the stamps as they are. 'auto': what
        the data say.
    given : float, optional
        Offset set by hand. [s]

    Raises
    ------
    BadInput
        If what is asked for cannot be found in the data.

    """
    bare = align_by_stamps(a, b)
    if manual_offset is not None:
        return replace(
            bare, how='given', offset=manual_offset, reason='The offset was given by hand.'
        )
    if align == 'none':
        return replace(bare, reason='The stamps were asked to be taken as they are.')
    if have_own_clocks(a.provenance, b.provenance):
        bare = replace(bare, on_stamps=False, lead=0.0)
    shared = select_invariants(pairs, bare)
    if align == 'motion':
        return align_by_start(bare, shared, 'It was asked for.')
    found = estimate_clock_offset(shared)
    bare = replace(bare, found=found)
    if align == 'clock':
        if found is None:
            raise BadInput(
                'No channel that both flights have moves alike in both, so their clocks cannot be '
                'told apart; give --offset, or --align none.'
            )
        return align_by_clock(bare, found, 'It was asked for.')
    return detect_alignment(a, b, pairs, bare, shared)


def detect_alignment(
    a: ComparedFlight,
    b: ComparedFlight,
    pairs: Sequence[ChannelPair],
    bare: TimeAlignment,
    shared: Sequence[SharedQuantity],
) -> TimeAlignment:
    """Return what the data say."""
    found = bare.found
    if bare.on_stamps and have_same_stamps(a, b, pairs):
        reason = 'Both carry the same stamps: they were timed by one clock, or count alike.'
        return replace(bare, reason=reason, remarks=describe_doubts(found))
    counted = have_own_clocks(a.provenance, b.provenance)
    if found is not None and found.correlation >= (SAME_COUNT if counted else SAME_RUN):
        reason = (
            f'Rates of change agree (correlation {found.correlation:.2f}) at this offset, as of '
            'one run recorded twice.'
        )
        return align_by_clock(bare, found, reason)
    if bare.on_stamps:
        reason = 'The stamps overlap, and nothing in the data ties the clocks more closely.'
        return replace(bare, reason=reason)
    try:
        reason = 'The clocks have nothing in common, and the motions differ: separate runs.'
        return align_by_start(bare, shared, reason)
    except BadInput:
        reason = (
            'Their clocks have nothing in common, and they show no start of motion or commands '
            'that both share.'
        )
        return replace(bare, reason=reason, remarks=describe_doubts(found))


def align_by_stamps(a: ComparedFlight, b: ComparedFlight) -> TimeAlignment:
    """Return the stamps as they are, or times from each start where the stamps do not overlap."""
    lead = (a.start - b.start) * 1e-9
    (begin_a, end_a), (begin_b, end_b) = a.span, b.span
    overlap = min(end_a, end_b - lead) - max(begin_a, begin_b - lead)
    on_stamps = overlap > 0.0
    return TimeAlignment('none', '', on_stamps, lead if on_stamps else 0.0)


def have_same_stamps(a: ComparedFlight, b: ComparedFlight, pairs: Sequence[ChannelPair]) -> bool:
    """Tell whether the flights begin at the same stamp and share most stamps to the nanosecond."""
    if a.start != b.start:
        return False
    shared = total = 0
    times = {(pair.a.topic, pair.b.topic): (pair.a.time, pair.b.time) for pair in pairs}
    for both in times.values():
        one, other = (np.unique(np.rint(time * 1e9).astype(np.int64)) for time in both)
        shared += len(np.intersect1d(one, other, assume_unique=True))
        total += min(len(one), len(other))
    return total > 0 and 2 * shared >= total


def align_by_clock(bare: TimeAlignment, estimate: ClockOffset, reason: str) -> TimeAlignment:
    """Return the offset that the data tell, applied."""
    remarks = []
    if estimate.is_ambiguous:
        remarks.append(
            'Another offset fits nearly as well, since the motion repeats itself; check it, and '
            'give --offset if it is wrong.'
        )
    return replace(
        bare, how='clock', reason=reason, offset=estimate.value, sigma=estimate.sigma,
        drift=estimate.drift if estimate.drifts else 0.0, middle=estimate.middle, found=estimate,
        used=estimate.used, remarks=tuple(remarks),
    )  # fmt: skip


def align_by_start(
    bare: TimeAlignment, shared: Sequence[SharedQuantity], reason: str
) -> TimeAlignment:
    """Return the starts laid on each other; `BadInput` where there are none."""
    start = find_common_start(shared)
    if start is None:
        raise BadInput(
            'The flights show no start of motion or commands that both share; give --offset, or '
            '--align none.'
        )
    what = 'commands' if start.by_command else 'motion'
    return replace(
        bare, how='motion', reason=f'{reason} The start of the {what} is laid on itself.',
        offset=start.offset, sigma=start.sigma, used=start.used,
    )  # fmt: skip


def describe_doubts(estimate: ClockOffset | None) -> tuple[str, ...]:
    """Return a remark where the data agree better with another offset than zero."""
    if estimate is None or estimate.correlation < SAME_RUN or estimate.is_ambiguous:
        return ()
    if abs(estimate.value) <= max(TELLING * estimate.sigma, 1e-3):
        return ()
    return (
        f'The motions themselves agree best {1e3 * estimate.value:+.1f} ms apart (deviation '
        f'{1e3 * estimate.sigma:.1f} ms): a lag of one flight, or of its clock; --align clock '
        f'takes '
        'it away.',
    )


def select_invariants(pairs: Sequence[ChannelPair], bare: TimeAlignment) -> list[SharedQuantity]:
    """Return what both flights measure and no world frame changes: places become ground speed."""
    found = []
    for pair in pairs:
        a = sort_samples(pair.a.time, pair.a.values)
        b = sort_samples(pair.b.time - bare.lead, pair.b.values)
        if not pair.name.endswith(PLACES):
            found.append(SharedQuantity(pair.name, a, b, pair.angular))
    by_name = {pair.name: pair for pair in pairs}
    for name, pair in by_name.items():
        other = by_name.get(name.removesuffix(PLACES[0]) + PLACES[1])
        if name.endswith(PLACES[0]) and other is not None:
            a = ground_speed(pair.a.time, pair.a.values, other.a.values)
            b = ground_speed(pair.b.time - bare.lead, pair.b.values, other.b.values)
            found.append(SharedQuantity(f'{name.removesuffix(".x")}.way', a, b))
    return found


def ground_speed(time: Array, x: Array, y: Array) -> SampledSignal:
    """Return the speed over ground in the plane, of places smoothed over 0.25 s. [m/s]"""
    of_x, of_y = sort_samples(time, x), sort_samples(time, y)
    count = len(of_x.time)
    if count < 8 or len(of_y.time) != count:
        return SampledSignal(np.empty(0), np.empty(0))
    step = max(0.05, float(np.median(np.diff(of_x.time))))
    half = 2.5 * step
    inner = of_x.time[(of_x.time >= of_x.time[0] + half) & (of_x.time <= of_x.time[-1] - half)]
    lags = np.linspace(-half, half, 6)
    rates = []
    for line in (of_x, of_y):
        near = np.stack([interpolate_signal(line, inner + lag) for lag in lags])
        rates.append(lags @ near / float(lags @ lags))
    return SampledSignal(inner, np.hypot(*rates))
