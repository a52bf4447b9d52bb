"""Whether the memory of a process is flat: what it holds, look by look, and the slope of that."""

from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

LEAK: Final = 4.0  # MB/h, the most that counts as flat: 100 MB a day


class Slope(NamedTuple):
    """How a process's memory changes: where it stands [MB], slope and half its interval [MB/h]."""

    held: float
    slope: float
    within: float

    @property
    def flat(self) -> bool:
        """Whether it is surely no leak, or too small to matter."""
        return self.slope - self.within < LEAK


def resident(pid: int) -> float:
    """Return the memory that is a process's own. [MB]"""
    for line in Path(f'/proc/{pid}/status').read_text().splitlines():
        if line.startswith('RssAnon:'):
            return float(line.split()[1]) / 1024.0
    raise ValueError(f'process {pid} has no memory')


def slope_of(times: NDArray[np.float64], held: NDArray[np.float64]) -> Slope:
    """
    Return the slope of memory by least squares, its interval from blocks that hang together.

    `times`, shape (looks,) [s]. `held`, shape (looks,) [MB].
    """
    hours = times / 3600.0
    line = np.polyfit(hours, held, 1)
    rest = held - np.polyval(line, hours)
    # Neighbours are alike: one look in so many counts.
    alike = np.clip(np.corrcoef(rest[:-1], rest[1:])[0, 1], 0.0, 0.99) if rest.std() > 0.0 else 0.0
    counted = max(3.0, len(hours) * (1.0 - alike) / (1.0 + alike))
    spread = np.sqrt((rest**2).sum() / len(hours)) / (hours.std() * np.sqrt(counted - 2.0))
    return Slope(float(held.mean()), float(line[0]), float(2.0 * spread))
