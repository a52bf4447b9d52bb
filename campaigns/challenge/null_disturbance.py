"""Define the base class of disturbances outside the library; it has no effect."""

from collections.abc import Mapping, Sequence

from campaigns.challenge.air import MovingAir
from campaigns.challenge.body import State, STILL
from campaigns.challenge.truth import Six

Numbers = Mapping[str, float]


class NullDisturbance:
    """
    A disturbance without effect.

    `numbers`: parameters by name; `size` scales the disturbance.
    """

    def __init__(self, numbers: Numbers) -> None:
        self.numbers = numbers
        self.size = numbers['size']

    def adjust_duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return the duties that the rotors follow."""
        return duties

    def adjust_thrusts(self, thrusts: Sequence[float], duties: Sequence[float]) -> Sequence[float]:
        """Return the changed thrust of each rotor. [N]"""
        return thrusts

    def air_motion(self) -> MovingAir | None:
        """Return its air motion, or None."""
        return None

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Advance by a step; return the wrench during it."""
        return STILL
