"""What the emulated Crazyflie is mounted on."""

from collections.abc import Mapping
from typing import final, Protocol

from lta_emulation.crazyflie.commander import BodyCommand

STILL = (0.0, 0.0, 0.0, 0.0)


class CrazyflieBody(Protocol):
    """Something that can be driven and that senses, in its own time."""

    @property
    def duties(self) -> tuple[float, ...]:
        """Present duty of M1 to M4, 0 to 1."""
        ...

    def advance(self, now: float, wish: BodyCommand) -> None:
        """Go on to a time since the boot, driven by a wish. [s]"""
        ...

    def read_values(self) -> Mapping[str, float]:
        """Return the newest values of log variables, in the firmware's units."""
        ...


@final
class BenchBody:
    """A Crazyflie that is clamped to a bench: motors turn, nothing moves."""

    def __init__(self) -> None:
        self.duties: tuple[float, ...] = STILL

    def advance(self, now: float, wish: BodyCommand) -> None:
        """Turn the motors, at a time [s]: a hover and a landing take half duty here."""
        del now
        duties = wish.duties
        if duties is None:
            duties = (0.5,) * 4 if wish.hover is not None or wish.land else STILL
        self.duties = tuple(max(wish.idle, duty) for duty in duties)

    def read_values(self) -> Mapping[str, float]:
        """Return what a Crazyflie at rest on a bench says."""
        return {'acc.z': 1.0, 'range.zrange': 450.0, 'baro.pressure': 1013.25}
