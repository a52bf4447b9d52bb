"""What one look at the machine found."""

from dataclasses import dataclass
from typing import final, Literal

MEGABYTE = 1_000_000
State = Literal['ok', 'warn', 'fail']


@final
@dataclass(frozen=True, slots=True)
class HardwareCheck:
    """
    The result of one check.

    Parameters
    ----------
    name : str
        What was looked at.
    state : {'ok', 'warn', 'fail'}
        `fail`: LTA cannot fly like this. `warn`: something will be slow or left out.
    found : str
        What was found, with its figures.
    remedy : str
        One sentence on what to do; empty if nothing needs doing.

    """

    name: str
    state: State
    found: str
    remedy: str = ''


def grade_figure(
    name: str, figure: float, warn: float, fail: float, finding: str, remedy: str
) -> HardwareCheck:
    """Return a check whose state follows from a figure that should not be below two limits."""
    state: State = 'ok' if figure >= warn else 'warn' if figure >= fail else 'fail'
    return HardwareCheck(name, state, finding, '' if state == 'ok' else remedy)
