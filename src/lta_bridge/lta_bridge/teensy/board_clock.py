"""
Which time of ours a time of the board's clock is, from questions and answers (TIMESYNC).

We ask at `asked`, the board answers with its own time, the answer is here at `heard`: the board's
time lies between the two, wherever the delay came from. The line through the middles is fitted by
least squares, where an answer counts the less the longer it was under way beyond the quickest; a
crystal's drift is small (prior, standard deviation `CRYSTAL`), so that the first seconds do not
make one up. A delay that is longer in one direction shifts the line by half the difference: no
exchange of messages can tell that from an offset.
"""

from collections import deque
from typing import final, NamedTuple

FEW = 4  # answers before a time is told: the first may have been long under way
KEPT = 128  # exchanges: half a minute at 4 Hz, in which a crystal's temperature stays
CRYSTAL = 100e-6  # standard deviation of a crystal's drift: twice a common part's 50 ppm
QUICK = 0.25  # of the quickest round trip: how far a middle is believed at best
GRAIN = 20e-6  # s: timers and schedulers are no finer
SLACK = 2e-3  # s by which an answer may contradict the line before another clock is assumed


class ClockExchange(NamedTuple):
    """One question and its answer: ours, the board's, ours. [ns]"""

    asked: int
    board: int
    heard: int

    @property
    def midpoint(self) -> int:
        """Our time halfway between question and answer. [ns]"""
        return (self.asked + self.heard) // 2

    @property
    def round_trip(self) -> int:
        """From question to answer. [ns]"""
        return self.heard - self.asked


@final
class BoardClock:
    """
    The board's clock against ours.

    Attributes
    ----------
    drift : float
        Part by which the board's clock is too slow: our seconds a board second, less one.
    uncertainty : float
        Standard deviation of our time of the newest answer, but for unequal delays. [s]
    restarts : int
        How often an answer contradicted all before: the board was reset, or our clock was set.

    """

    def __init__(self) -> None:
        self._kept: deque[ClockExchange] = deque(maxlen=KEPT)
        self._base = 0
        self._anchor = 0
        self._offset = 0.0
        self.drift = 0.0
        self.uncertainty = 0.0
        self.restarts = 0

    @property
    def is_synchronized(self) -> bool:
        """Whether the board has answered often enough."""
        return len(self._kept) >= FEW

    @property
    def round_trip(self) -> int:
        """The quickest of the exchanges that are kept. [ns]"""
        return min(item.round_trip for item in self._kept)

    def to_host_time(self, board_ns: int) -> int:
        """Return our time of a time of the board's clock. [ns]"""
        since = board_ns - self._base
        return self._anchor + since + round(self._offset + self.drift * since)

    def add_exchange(self, exchange: ClockExchange) -> None:
        """Take an exchange; begin anew where it contradicts what was known."""
        if self._kept and self._contradicts_fit(exchange):
            self.restart()
        self._kept.append(exchange)
        self._fit_offset_drift()

    def restart(self) -> None:
        """Forget all exchanges: the board was reset, or our clock was set."""
        self._kept.clear()
        self.restarts += 1

    def _contradicts_fit(self, exchange: ClockExchange) -> bool:
        slack = 1e9 * (SLACK + 3.0 * self.uncertainty)
        predicted = self.to_host_time(exchange.board)
        return not exchange.asked - slack <= predicted <= exchange.heard + slack

    def _fit_offset_drift(self) -> None:
        """Fit offset and drift about the newest answer: there it is used."""
        newest = self._kept[-1]
        self._base, self._anchor = newest.board, newest.midpoint
        quickest = self.round_trip
        best = QUICK * quickest * 1e-9 + GRAIN
        # Precision matrix and right side of (offset, drift); the prior of the drift is about zero.
        aa = ab = bb = ya = yb = 0.0
        for item in self._kept:
            weight = (best + 1e-9 * (item.round_trip - quickest)) ** -2
            x = 1e-9 * (item.board - self._base)
            y = 1e-9 * (item.midpoint - self._anchor) - x
            aa += weight
            ab += weight * x
            bb += weight * x * x
            ya += weight * y
            yb += weight * x * y
        bb += CRYSTAL**-2
        determinant = aa * bb - ab * ab
        self._offset = 1e9 * (ya * bb - yb * ab) / determinant
        self.drift = (yb * aa - ya * ab) / determinant
        self.uncertainty = (bb / determinant) ** 0.5
