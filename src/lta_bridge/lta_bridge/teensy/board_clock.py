# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Synchronize with the board's clock by time requests and answers (TIMESYNC).

The request is sent at `asked`, the board answers with its own time, and the answer arrives at
`heard`: the board's time lies between the two. A line is fitted through the midpoints by weighted
least squares; exchanges slower than the fastest one weigh less. A prior on the drift (standard
deviation `CRYSTAL`) keeps the first seconds from producing a false one. Unequal delays in the two
directions shift the line by half their difference, which no exchange can detect.
"""

from collections import deque
from typing import final, NamedTuple

LEAST_ANSWERS = 4  # answers before the clock counts as synchronized: the first may have been slow
# Exchanges: half a minute at 4 Hz, in which a crystal's temperature is constant
CLOCK_EXCHANGES = 128
CRYSTAL = 100e-6  # standard deviation of a crystal's drift: twice a common part's 50 ppm
QUICK_DEVIATION = 0.25  # smallest standard deviation of a midpoint, by the fastest round trip
GRAIN = 20e-6  # s, resolution of timers and schedulers
# s; an answer that contradicts the line by more means that a clock was reset
CLOCK_RESET_ERROR = 2e-3


class ClockExchange(NamedTuple):
    """One exchange: host time of the request, board time, host time of the answer [ns]."""

    request_ns: int
    board: int
    reply_ns: int

    @property
    def host_midpoint(self) -> int:
        """Host time halfway between request and answer [ns]."""
        return (self.request_ns + self.reply_ns) // 2

    @property
    def round_trip(self) -> int:
        """Time from request to answer [ns]."""
        return self.reply_ns - self.request_ns


@final
class BoardClock:
    """
    Estimate the board's clock relative to the host's.

    Attributes
    ----------
    drift : float
        Relative rate error, positive if the board is slow: host seconds per board second, minus 1.
    uncertainty : float
        Standard deviation at the newest answer, without the effect of unequal delays. [s]
    restarts : int
        Number of resets of the board or of the host's clock, detected by a contradiction.

    """

    def __init__(self) -> None:
        self._exchanges: deque[ClockExchange] = deque(maxlen=CLOCK_EXCHANGES)
        self._base = 0
        self._anchor = 0
        self._offset = 0.0
        self.drift = 0.0
        self.uncertainty = 0.0
        self.restarts = 0

    @property
    def is_synchronized(self) -> bool:
        """Whether the board has answered often enough."""
        return len(self._exchanges) >= LEAST_ANSWERS

    @property
    def round_trip(self) -> int:
        """Shortest round trip of the stored exchanges [ns]."""
        return min(item.round_trip for item in self._exchanges)

    def to_host_time(self, board_ns: int) -> int:
        """Convert a board time to host time [ns]."""
        since = board_ns - self._base
        # Integers for the large parts: float64 does not resolve 1 ns in times since 1970
        return self._anchor + since + round(self._offset + self.drift * since)

    def add_exchange(self, exchange: ClockExchange) -> None:
        """Add an exchange; restart if it contradicts the estimate."""
        if self._exchanges and self._contradicts_fit(exchange):
            self.discard_exchanges()
        self._exchanges.append(exchange)
        self._fit_offset_drift()

    def discard_exchanges(self) -> None:
        """Discard all exchanges: the board was reset, or the host's clock was set."""
        self._exchanges.clear()
        self.restarts += 1

    def _contradicts_fit(self, exchange: ClockExchange) -> bool:
        slack = 1e9 * (CLOCK_RESET_ERROR + 3.0 * self.uncertainty)
        predicted = self.to_host_time(exchange.board)
        # The board read its clock between request and answer
        return not exchange.request_ns - slack <= predicted <= exchange.reply_ns + slack

    def _fit_offset_drift(self) -> None:
        """Fit offset and drift about the newest answer, where they are used."""
        newest = self._exchanges[-1]
        self._base, self._anchor = newest.board, newest.host_midpoint
        quickest = self.round_trip
        # Even the fastest exchange may be asymmetric
        best = QUICK_DEVIATION * quickest * 1e-9 + GRAIN
        # Normal equations of (offset, drift); the prior of the drift has mean zero.
        aa = ab = bb = ya = yb = 0.0
        for item in self._exchanges:
            # Extra delay may be on one way only, so it adds to the midpoint's deviation
            weight = (best + 1e-9 * (item.round_trip - quickest)) ** -2
            # s; relative to the newest answer, for precision
            x = 1e-9 * (item.board - self._base)
            y = 1e-9 * (item.host_midpoint - self._anchor) - x
            aa += weight
            ab += weight * x
            bb += weight * x * x
            ya += weight * y
            yb += weight * x * y
        # The prior: keeps the drift small while the exchanges span a short time
        bb += CRYSTAL**-2
        determinant = aa * bb - ab * ab
        self._offset = 1e9 * (ya * bb - yb * ab) / determinant
        self.drift = (yb * aa - ya * ab) / determinant
        # Element of the inverse of the normal matrix: standard deviation of the offset [s]
        self.uncertainty = (bb / determinant) ** 0.5
