"""Who holds the graph up, told only once it is sure."""

import time
from typing import final

SETTLE = 0.5  # wall seconds; nodes look at their inputs at different moments
DISCOVERY = 4.0  # wall seconds; while some nodes have not been found yet, the others mislead


@final
class Blame:
    """
    Turn what is heard of the nodes into names.

    A node that hangs falls silent, and is named at once. One that goes on to report and yet does
    not answer is found by what the others wait for, which takes a moment to settle.

    Attributes
    ----------
    standing : float
        For how long somebody has held the graph up. [wall s]

    """

    def __init__(self) -> None:
        self._suspects: list[str] = []
        self._changed = self._well = time.monotonic()
        self.standing = 0.0

    def look(self, suspects: list[str], silent: list[str], all_heard: bool) -> list[str]:
        """
        Return whom to name.

        Parameters
        ----------
        suspects : list of str
            For whom others say that they wait.
        silent : list of str
            Nodes that run and are no longer heard.
        all_heard : bool
            Whether every node that runs has been heard.

        """
        now = time.monotonic()
        if suspects != self._suspects:
            self._suspects, self._changed = suspects, now
        if not suspects and not silent:
            self._well = now
        self.standing = now - self._well
        settled = now - self._changed > (SETTLE if all_heard else DISCOVERY)
        return silent or (suspects if settled else [])
