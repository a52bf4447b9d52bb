# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Interface of a control law: from motion and setpoint to rotor commands.

A law consists of plain functions of scalars and tuples with memory in and out, so that the same
code runs in a node and compiled in a loop. `lta_control.flight_step` says when it is asked.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, final, NamedTuple, Protocol

from lta_config.settings import Settings
from lta_control.allocation import NO_ROTORS, PerRotor
from lta_control.motion import ControlMotion, Setpoint, Vector
from lta_model.vehicle import Vehicle

UNMOVED: Vector = (0.0, 0.0, 0.0)


class Feedback(StrEnum):
    """Source of a law's feedback."""

    ESTIMATOR = 'estimator'  # onboard sensors
    TRACKER = 'tracker'  # pose and velocity of an external tracker, rates of the onboard gyroscope


class LawInputs(NamedTuple):
    """Input of a law at each step: motion, setpoint, and the time since the last step [s]."""

    motion: ControlMotion = ControlMotion()
    setpoint: Setpoint = Setpoint(0.0, 0.0, 0.0)
    dt: float = 0.01


class LawCommand(NamedTuple):
    """Output of a law: duties by slot, and the position of the moving mass if there is one."""

    duties: PerRotor = NO_ROTORS
    mass_place: Vector = UNMOVED  # body frame [m]


class LawMemory(Protocol):
    """State of a law between steps, a named tuple of numbers and tuples."""

    @property
    def command(self) -> LawCommand:
        """Return the latest command."""


@final
@dataclass(frozen=True, slots=True)
class ControlLaw:
    """
    A control law; a new one needs one file with its functions and a `LAW`, and a registry line.

    Parameters
    ----------
    name : str
        Name in vehicle files.
    gains : type of Settings
        Tunable gains; the values of each vehicle are in `config/control/`.
    feedback : Feedback
        Source of the feedback.
    build_constants : callable
        `build_constants(gains, vehicle) -> constants`, a named tuple with the gains as `gains`;
        raises `BadInput` for a vehicle that it cannot fly.
    start : LawMemory
        The memory before the first step.
    step : callable
        `step(constants, memory, inputs, scratch) -> memory`.
    moves_mass : bool
        Whether its commands have a position of the moving mass.

    """

    name: str
    gains: type[Settings]
    feedback: Feedback
    build_constants: Callable[[Any, Vehicle], Any]
    start: LawMemory
    step: Callable[[Any, Any, LawInputs, Any], LawMemory]
    moves_mass: bool = False

    @property
    def is_tracked(self) -> bool:
        """Whether it needs a tracker."""
        return self.feedback is Feedback.TRACKER
