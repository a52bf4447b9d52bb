"""Define the interface of a check."""

from typing import Protocol

from lta_data.data_quality.check_context import CheckContext
from lta_data.data_quality.finding import CheckVerdict


class QualityCheck(Protocol):
    """
    One check of a recording.

    A check is pure: it changes nothing, reads no file, and reports what it cannot judge.
    """

    def __call__(self, evidence: CheckContext) -> CheckVerdict:
        """Return the findings and what could not be judged."""
        ...
