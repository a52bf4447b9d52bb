"""Accept one sender at a time on a shared link."""

from collections.abc import Hashable
from typing import Final, final

LOYAL_NS: Final = 2_000_000_000  # of silence after which another sender is accepted


@final
class SenderFilter:
    """
    Accept the first sender until it has been silent for a while; count all others.

    Two boards on one link would mix their rows, and a third party could fake a lamp. The filter
    cannot know the right sender, but it never mixes two.

    Attribute `who`: the accepted sender; None before the first. Attribute `others`: number of
    ignored messages from other senders.
    """

    def __init__(self) -> None:
        self.who: Hashable | None = None
        self.others = 0
        self._heard_ns = 0

    def accept_sender(self, who: Hashable, now_ns: int) -> bool:
        """Return whether to accept a message of a sender that arrives now. [ns]"""
        loyal = (
            0 <= now_ns - self._heard_ns <= LOYAL_NS
        )  # a clock that was set back also ends the preference
        if self.who is None or (who != self.who and not loyal):
            self.who = who
        if who != self.who:
            self.others += 1
            return False
        self._heard_ns = now_ns
        return True
