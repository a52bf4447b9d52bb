"""How B's time is laid on A's: by a common clock, by the start of motion, as given, or not."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final, Literal

from lta_config.errors import BadInput
from lta_data.compare.clock import clock_offset, Offset
from lta_data.compare.lag import Shared
from lta_data.compare.line import Array, Line, ordered, sampled
from lta_data.compare.pairs import Pair
from lta_data.compare.side import Side
from lta_data.compare.starts import common_start
from lta_data.foreign.clocks import own_clocks
import numpy as np

Align = Literal['auto', 'clock', 'motion', 'none']
SAME_RUN: Final = 0.9  # correlation of rates that one run recorded twice has, and two runs do not
SAME_COUNT: Final = 0.98  # the same of logs that are both without a clock: repeats reach 0.961
TELLING: Final = 3  # deviations of an offset that is remarked on
PLACES: Final = ('position.x', 'position.y')


@final
@dataclass(frozen=True, slots=True)
class Timing:
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
    found: Offset | None = None
    used: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    def on_a(self, time: Array) -> Array:
        """Return times of B, since its start, as times since A's start. [s]"""
        shifted = time - self.lead - self.offset + self.drift * self.middle
        return np.asarray(shifted / (1.0 + self.drift))


def timing(
    a: Side, b: Side, pairs: Sequence[Pair], align: Align = 'auto', given: float | None = None
) -> Timing:
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
    bare = plain(a, b)
    if given is not None:
        return replace(bare, how='given', offset=given, reason='The offset was given by hand.')
    if align == 'none':
        return replace(bare, reason='The stamps were asked to be taken as they are.')
    if own_clocks(a.provenance, b.provenance):
        bare = replace(bare, on_stamps=False, lead=0.0)
    shared = invariants(pairs, bare)
    if align == 'motion':
        return by_start(bare, shared, 'It was asked for.')
    found = clock_offset(shared)
    bare = replace(bare, found=found)
    if align == 'clock':
        if found is None:
            raise BadInput(
                'No channel that both flights have moves alike in both, so their clocks cannot be '
                'told apart; give --offset, or --align none.'
            )
        return by_clock(bare, found, 'It was asked for.')
    return decided(a, b, pairs, bare, shared)


def decided(
    a: Side, b: Side, pairs: Sequence[Pair], bare: Timing, shared: Sequence[Shared]
) -> Timing:
    """Return what the data say."""
    found = bare.found
    if bare.on_stamps and same_stamps(a, b, pairs):
        reason = 'Both carry the same stamps: they were timed by one clock, or count alike.'
        return replace(bare, reason=reason, remarks=doubts(found))
    counted = own_clocks(a.provenance, b.provenance)
    if found is not None and found.correlation >= (SAME_COUNT if counted else SAME_RUN):
        reason = (
            f'Rates of change agree (correlation {found.correlation:.2f}) at this offset, as of '
            'one run recorded twice.'
        )
        return by_clock(bare, found, reason)
    if bare.on_stamps:
        reason = 'The stamps overlap, and nothing in the data ties the clocks more closely.'
        return replace(bare, reason=reason)
    try:
        reason = 'The clocks have nothing in common, and the motions differ: separate runs.'
        return by_start(bare, shared, reason)
    except BadInput:
        reason = (
            'Their clocks have nothing in common, and they show no start of motion or commands '
            'that both share.'
        )
        return replace(bare, reason=reason, remarks=doubts(found))


def plain(a: Side, b: Side) -> Timing:
    """Return the stamps as they are, or times from each start where the stamps do not overlap."""
    lead = (a.start - b.start) * 1e-9
    (begin_a, end_a), (begin_b, end_b) = a.span, b.span
    overlap = min(end_a, end_b - lead) - max(begin_a, begin_b - lead)
    on_stamps = overlap > 0.0
    return Timing('none', '', on_stamps, lead if on_stamps else 0.0)


def same_stamps(a: Side, b: Side, pairs: Sequence[Pair]) -> bool:
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


def by_clock(bare: Timing, found: Offset, reason: str) -> Timing:
    """Return the offset that the data tell, applied."""
    remarks = []
    if found.ambiguous:
        remarks.append(
            'Another offset fits nearly as well, since the motion repeats itself; check it, and '
            'give --offset if it is wrong.'
        )
    return replace(
        bare, how='clock', reason=reason, offset=found.value, sigma=found.sigma,
        drift=found.drift if found.drifts else 0.0, middle=found.middle, found=found,
        used=found.used, remarks=tuple(remarks),
    )  # fmt: skip


def by_start(bare: Timing, shared: Sequence[Shared], reason: str) -> Timing:
    """Return the starts laid on each other; `BadInput` where there are none."""
    start = common_start(shared)
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


def doubts(found: Offset | None) -> tuple[str, ...]:
    """Return a remark where the data agree better with another offset than zero."""
    if found is None or found.correlation < SAME_RUN or found.ambiguous:
        return ()
    if abs(found.value) <= max(TELLING * found.sigma, 1e-3):
        return ()
    return (
        f'The motions themselves agree best {1e3 * found.value:+.1f} ms apart (deviation '
        f'{1e3 * found.sigma:.1f} ms): a lag of one flight, or of its clock; --align clock takes '
        'it away.',
    )


def invariants(pairs: Sequence[Pair], bare: Timing) -> list[Shared]:
    """Return what both flights measure and no world frame changes: places become ground speed."""
    found = []
    for pair in pairs:
        a = ordered(pair.a.time, pair.a.values)
        b = ordered(pair.b.time - bare.lead, pair.b.values)
        if not pair.name.endswith(PLACES):
            found.append(Shared(pair.name, a, b, pair.angular))
    by_name = {pair.name: pair for pair in pairs}
    for name, pair in by_name.items():
        other = by_name.get(name.removesuffix(PLACES[0]) + PLACES[1])
        if name.endswith(PLACES[0]) and other is not None:
            a = way(pair.a.time, pair.a.values, other.a.values)
            b = way(pair.b.time - bare.lead, pair.b.values, other.b.values)
            found.append(Shared(f'{name.removesuffix(".x")}.way', a, b))
    return found


def way(time: Array, x: Array, y: Array) -> Line:
    """Return the speed over ground in the plane, of places smoothed over 0.25 s. [m/s]"""
    of_x, of_y = ordered(time, x), ordered(time, y)
    count = len(of_x.time)
    if count < 8 or len(of_y.time) != count:
        return Line(np.empty(0), np.empty(0))
    step = max(0.05, float(np.median(np.diff(of_x.time))))
    half = 2.5 * step
    inner = of_x.time[(of_x.time >= of_x.time[0] + half) & (of_x.time <= of_x.time[-1] - half)]
    lags = np.linspace(-half, half, 6)
    rates = []
    for line in (of_x, of_y):
        near = np.stack([sampled(line, inner + lag) for lag in lags])
        rates.append(lags @ near / float(lags @ lags))
    return Line(inner, np.hypot(*rates))
