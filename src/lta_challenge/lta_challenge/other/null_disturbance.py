"""Define the base of all disturbances outside the library, which has no effect."""

from collections.abc import Mapping, Sequence

from lta_challenge.other.air import MovingAir
from lta_challenge.other.body import State, STILL
from lta_challenge.other.truth import Six

Numbers = Mapping[str, float]


class NullDisturbance:
    """
    Something that does nothing.

    Parameters
    ----------
    numbers : mapping of str to float
        What it is made of, by name; the one called `size` scales it.

    """

    def __init__(self, numbers: Numbers) -> None:
        self.numbers = numbers
        self.size = numbers['size']

    def adjust_duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return what the rotors do of what is commanded."""
        return duties

    def adjust_thrusts(self, thrusts: Sequence[float], duties: Sequence[float]) -> Sequence[float]:
        """Return what comes of the thrust of each rotor. [N]."""
        return thrusts

    def moving_air(self) -> MovingAir | None:
        """Return how it moves the air."""
        return None

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Return its wrench over the next step, and go on."""
        return STILL
