"""What a check is."""

from typing import Protocol

from lta_data.data_quality.check_context import CheckContext
from lta_data.data_quality.finding import CheckVerdict


class QualityCheck(Protocol):
    """
    One question put to a recording.

    A check is pure: it changes nothing, reads no file, and says of what it cannot judge why.
    """

    def __call__(self, evidence: CheckContext) -> CheckVerdict:
        """Return what was found and what could not be judged."""
        ...
