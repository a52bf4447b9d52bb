"""The outdoor area beyond a building's door, with its own light and air."""

from dataclasses import dataclass
import math
from typing import final

from lta_model.light.daylight import Daylight
from lta_model.light.light_checks import require

Vector = tuple[float, float, float]


@final
@dataclass(frozen=True, slots=True)
class OutdoorArea:
    """The open beyond a door in the wall at the high end of map x, down to the floor."""

    daylight: Daylight  # light outdoors
    middle: float  # middle of the door along map y [m]
    # Of the door [m]
    width: float
    height: float

    def __post_init__(self) -> None:
        """Refuse an impossible door."""
        require(
            math.isfinite(self.middle) and self.width > 0.0 and self.height > 0.0,
            f'The door is {self.width} m wide and {self.height} m high; make both positive.',
        )
