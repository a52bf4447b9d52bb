"""Where on the bag's clock a replay is by the wall clock: at a rate, paused, or step by step."""

from typing import final

from lta_bridge.playback.pending_answers import NEVER


@final
class PlaybackClock:
    """
    The transport of a player.

    Parameters
    ----------
    begin_ns : int
        Time of the first message, on the bag's clock. [ns]
    rate : float or None
        Bag seconds a wall second; None for as fast as others allow.
    paused : bool
        Whether to begin with a pause, before the first message.

    """

    def __init__(self, begin_ns: int, rate: float | None, paused: bool) -> None:
        self._at = begin_ns - 1 if paused else begin_ns
        self._rate = rate
        self._since: float | None = None
        self.paused = paused

    def start(self, wall: float) -> None:
        """Let time run from now on, unless paused. [s]"""
        self._since = wall

    def now(self, wall: float) -> int:
        """Return up to which time to play. [ns]"""
        if self.paused or self._since is None:
            return self._at
        if self._rate is None:
            return NEVER
        return self._at + round(self._rate * 1e9 * (wall - self._since))

    def pause(self, wall: float, played_ns: int) -> None:
        """Stop at a wall time [s]: at a rate where time is, else behind the last message [ns]."""
        if not self.paused:
            self._at = played_ns if self._rate is None else self.now(wall)
            self.paused = True

    def resume(self, wall: float) -> None:
        """Go on, at a wall time [s], from where it stopped."""
        if self.paused:
            self._since = wall
            self.paused = False

    def step(self, to_ns: int) -> None:
        """Move a paused replay on to a time. [ns]"""
        self._at = max(self._at, to_ns)
