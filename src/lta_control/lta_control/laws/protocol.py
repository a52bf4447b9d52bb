"""
What a control law is: from where the vehicle is and should be to what its rotors do.

A law is plain functions of scalars and tuples, memory handed in and out, so that it runs as it
stands in a node and compiled in a loop (`lta_config.compilation.flat`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, final, NamedTuple

from lta_config.settings import Settings
from lta_control.attitude import Quaternion, Vector
from lta_control.cascade import Setpoint
from lta_control.per_rotor import NONE, PerRotor
from lta_model.vehicle import Vehicle

UNMOVED: Vector = (0.0, 0.0, 0.0)


class Feedback(StrEnum):
    """What a law flies by."""

    ESTIMATOR = 'estimator'  # the drone's own sensors
    TRACKER = 'tracker'  # an outside tracker's pose and velocity, and the drone's own gyroscope


class ControlMotion(NamedTuple):
    """
    Where the vehicle is, as its law sees it; the frame begins with the vehicle's start.

    Attributes
    ----------
    position : tuple
        Of the hull centre; z above the floor. x and y are dead reckoning where no tracker looks.
        [m]
    attitude : tuple
        Body to that frame, x y z w.
    velocity : tuple
        Body frame: over ground by a tracker, through the air by the estimator. [m/s]
    rates : tuple
        Body frame. [rad/s]

    """

    position: Vector = (0.0, 0.0, 0.0)
    attitude: Quaternion = (0.0, 0.0, 0.0, 1.0)
    velocity: Vector = (0.0, 0.0, 0.0)
    rates: Vector = (0.0, 0.0, 0.0)


class LawInputs(NamedTuple):
    """What a law is given at each step: motion, setpoint, and the time since the last. [s]"""

    motion: ControlMotion = ControlMotion()
    setpoint: Setpoint = Setpoint(0.0, 0.0, 0.0)
    dt: float = 0.01


class LawCommand(NamedTuple):
    """What a law asks for: duties by slot, and the place of a moving mass where there is one."""

    duties: PerRotor = NONE
    mass_place: Vector = UNMOVED  # body frame [m]


@final
@dataclass(frozen=True, slots=True)
class ControlLaw:
    """
    A control law. A new one is one file with its functions and a `LAW`, and one registry line.

    Parameters
    ----------
    name : str
        As vehicle files call it.
    gains : type of Settings
        What can be tuned; a vehicle's values are in `config/control/`.
    feedback : Feedback
        What it needs to see; a law that needs a tracker says so here.
    known : callable
        `known(gains, vehicle) -> constants`, a named tuple of numbers, the gains as `gains` among
        them; a `BadInput` for a vehicle that it cannot fly.
    start : tuple
        The memory before the first step, a named tuple with a `LawCommand` as `command`.
    step : callable
        `step(constants, memory, heard, scratch) -> memory`.

    """

    name: str
    gains: type[Settings]
    feedback: Feedback
    known: Callable[[Any, Vehicle], Any]
    start: Any
    step: Callable[[Any, Any, LawInputs, Any], Any]
