"""Results of hardware and system checks."""

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
        Subject of the check.
    state : {'ok', 'warn', 'fail'}
        `fail`: LTA cannot fly like this. `warn`: something will be slow or left out.
    found : str
        The finding, with its figures.
    remedy : str
        What to do, in one sentence; empty if nothing needs doing.

    """

    name: str
    state: State
    found: str
    remedy: str = ''


def grade_value(
    name: str, figure: float, warn: float, fail: float, finding: str, remedy: str
) -> HardwareCheck:
    """Return a check that warns or fails if the figure is below the respective limit."""
    state: State = 'ok' if figure >= warn else 'warn' if figure >= fail else 'fail'
    return HardwareCheck(name, state, finding, '' if state == 'ok' else remedy)
