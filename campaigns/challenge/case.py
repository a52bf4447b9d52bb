"""What a case is: flights with hidden effects, and the answer."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Streams = Mapping[str, tuple[Array, Array]]  # times [s] and values by topic
Kind = Literal['clean', 'single', 'pair', 'outside', 'mixed']

# Probabilities of what is hidden, if none is requested
KINDS: Final[dict[Kind, float]] = {
    'clean': 0.3, 'single': 0.25, 'pair': 0.15, 'outside': 0.15, 'mixed': 0.15,
}  # fmt: skip
ROLES: Final = ('train', 'confirm', 'holdout')
LEARNED: Final = (0, 1)  # indices of the flights from which discovery learns
SECONDS: Final = (60.0, 180.0)  # s; range of flight lengths


@final
@dataclass(frozen=True, slots=True)
class CaseFlight:
    """A recorded flight of a case."""

    name: str  # of its bag
    role: str  # 'train', 'confirm' or 'holdout'
    course: str
    streams: Streams


@final
@dataclass(frozen=True, slots=True)
class ChallengeCase:
    """A case."""

    number: int
    flights: tuple[CaseFlight, ...]
    answer: dict[str, Any]
