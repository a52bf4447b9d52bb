"""Represent one topic of a flight as arrays over time."""

from dataclasses import dataclass
from typing import Any, final

from lta_config.errors import unknown_name_error
import numpy as np
from numpy.typing import NDArray


@final
@dataclass(frozen=True, slots=True)
class TopicSeries:
    """Fields of one topic over time; `series['pose.pose.position.x']` returns one of them."""

    # In the order of recording; for messages without a stamp, the log time converted to the clock
    # of the stamps, shape (n,) [ns]
    stamps: NDArray[np.int64]
    time: NDArray[np.float64]  # the same since the start of the flight, shape (n,) [s]
    # Numeric fields by path, in the units of the message, shape (n,)
    numbers: dict[str, NDArray[Any]]
    texts: dict[str, NDArray[Any]]  # text fields by path, shape (n,)

    def __len__(self) -> int:
        """Return the number of messages."""
        return len(self.time)

    def __getitem__(self, path: str) -> NDArray[Any]:
        """Return a numeric field; raise `BadInput` with the known paths if it is unknown."""
        if path not in self.numbers:
            raise unknown_name_error('field', path, list(self.numbers))
        return self.numbers[path]

    def vector(self, path: str) -> NDArray[np.float64]:
        """
        Return the components x, y, z and, if present, w of a field, shape (n, 3) or (n, 4).

        `path` is, for example, 'pose.pose.position' or 'pose.pose.orientation'.
        """
        parts = [self[f'{path}.{axis}'] for axis in 'xyz']
        if f'{path}.w' in self.numbers:
            parts.append(self.numbers[f'{path}.w'])
        return np.stack(parts, axis=1).astype(np.float64)
