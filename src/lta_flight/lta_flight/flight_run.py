# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The result of a flight, of the graph or of one process."""

from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final, final

SIMULATED_ROBOT = 'lta1'
# Exit status of a command by the outcome of its flight; 2 is bad input. A flight is still `flying`
# or `landed` where another node ends its run as planned, and `flown` where recorded commands are
# at their end.
EXIT_STATUSES: Final = MappingProxyType(
    {
        'reached': 0,
        'flown': 0,
        'flying': 0,
        'landed': 0,
        'failed': 1,
        'timeout': 3,
        'escaped': 4,
    }
)


@final
@dataclass(frozen=True, slots=True)
class FlightRun:
    """The result of a flight."""

    # Results folder and recording
    folder: Path
    bag: Path
    outcome: str  # one of `EXIT_STATUSES`; 'failed' if the graph broke
    sentence: str  # the outcome in words, to be put after 'The drone'
    pace: float  # flight seconds per wall second
    # Whether the flight left the region of validity or of the law of the vehicle file; '' if not
    warning: str = ''
