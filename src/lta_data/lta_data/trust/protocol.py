"""What a check is."""

from typing import Protocol

from lta_data.trust.evidence import Evidence
from lta_data.trust.finding import Verdict


class Check(Protocol):
    """
    One question put to a recording.

    A check is pure: it changes nothing, reads no file, and says of what it cannot judge why.
    """

    def __call__(self, evidence: Evidence) -> Verdict:
        """Return what was found and what could not be judged."""
        ...
