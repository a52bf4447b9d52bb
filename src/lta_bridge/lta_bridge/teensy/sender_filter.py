"""Of all who may send, the one who is believed."""

from collections.abc import Hashable
from typing import Final, final

LOYAL_NS: Final = 2_000_000_000  # of silence, after which another may be believed


@final
class SenderFilter:
    """
    Believe whoever spoke first, until it has been silent for a while; count the others.

    Two boards on one link would tear each other's light, and a stranger could show a lamp that is
    not there. Which of two is the right one nobody can tell here, but one is kept to.

    Attributes
    ----------
    who : hashable or None
        Who is believed; None before the first.
    others : int
        How much was left out because others sent it.

    """

    def __init__(self) -> None:
        self.who: Hashable | None = None
        self.others = 0
        self._heard_ns = 0

    def accept_sender(self, who: Hashable, now_ns: int) -> bool:
        """Tell whether what somebody sends counts, and take note that it came. [ns]"""
        loyal = 0 <= now_ns - self._heard_ns <= LOYAL_NS  # a clock that was set back begins anew
        if self.who is None or (who != self.who and not loyal):
            self.who = who
        if who != self.who:
            self.others += 1
            return False
        self._heard_ns = now_ns
        return True
