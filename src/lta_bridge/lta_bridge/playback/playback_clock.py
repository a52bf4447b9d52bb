"""Map the wall clock to the bag's clock during a replay: at a rate, paused, or stepped."""

from typing import final

from lta_bridge.playback.pending_answers import NEVER_NS


@final
class PlaybackClock:
    """
    Position of a player on the bag's clock.

    `begin_ns`: time of the first message, on the bag's clock [ns]. `rate`: bag seconds per wall
    second; None for no limit. `paused`: whether to start paused, before the first message.
    """

    def __init__(self, begin_ns: int, rate: float | None, paused: bool) -> None:
        self._at = begin_ns - 1 if paused else begin_ns
        self._rate = rate
        self._since: float | None = None
        self.paused = paused

    def start(self, wall: float) -> None:
        """Start at a wall time, unless paused. [s]"""
        self._since = wall

    def now(self, wall: float) -> int:
        """Return the time up to which to play. [ns]"""
        if self.paused or self._since is None:
            return self._at
        if self._rate is None:
            return NEVER_NS
        return self._at + round(self._rate * 1e9 * (wall - self._since))

    def pause(self, wall: float, played_ns: int) -> None:
        """Pause at a wall time [s]; without a rate, after the last played message [ns]."""
        if not self.paused:
            self._at = played_ns if self._rate is None else self.now(wall)
            self.paused = True

    def resume(self, wall: float) -> None:
        """Resume at a wall time. [s]"""
        if self.paused:
            self._since = wall
            self.paused = False

    def step(self, to_ns: int) -> None:
        """Advance a paused replay to a time. [ns]"""
        self._at = max(self._at, to_ns)
