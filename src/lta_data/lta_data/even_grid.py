"""
Check whether the time stamps of a recording allow an even grid, and build it.

A computer that sets its clock while recording, by hours or from 1970 to today, creates stamps
that span years: a 100 Hz grid over them would not fit into memory. So every size that follows from
a span of time is checked here against the number of messages.
"""

from lta_config.errors import BadInput
from lta_config.limits import GRID
import numpy as np
from numpy.typing import NDArray

EMPTY = np.empty(0)
HOLES = 3.0  # grid points per sample, at most; more would be mostly gaps
FINEST = 1e-9  # s; resolution of a ROS stamp


def is_grid_allowed(span: float, step: float, samples: int, most: float = HOLES) -> bool:
    """Return whether a grid over so many samples may have such a span and step. [s]"""
    # Short grids are always allowed, however sparse.
    return span / max(FINEST, step) <= max(GRID, most * samples)


def check_time_span(
    who: str, span: float, step: float, samples: int, most: float = HOLES, remedy: str = ''
) -> None:
    """
    Refuse time stamps that span too long for their number.

    Parameters
    ----------
    who : str
        Whose time stamps they are, as in "of 'odom'"; may be empty.
    span, step : float
        From the first to the last, and of the grid that is needed. [s]
    samples : int
        Number of messages.
    most : float
        Grid points per message, at most.
    remedy : str
        What else helps, before 'check with ...'; may be empty.

    Raises
    ------
    BadInput
        If the grid would have far more points than there are messages.

    """
    if is_grid_allowed(span, step, samples, most):
        return
    raise BadInput(
        f'The time stamps{f" {who}" if who else ""} span {span:.0f} s, too long to resample at '
        f'{1.0 / max(FINEST, step):g} Hz; {f"{remedy}, or " if remedy else ""}check with '
        '`lta bag check` whether the system clock was changed during the recording.'
    )


def build_uniform_time_grid(
    first: float, last: float, step: float, samples: int
) -> NDArray[np.float64]:
    """Return an even grid over `samples` samples, empty if it would be too long. [s]"""
    allowed = is_grid_allowed(last - first, step, samples)
    return np.arange(first, last, max(FINEST, step)) if allowed else EMPTY
