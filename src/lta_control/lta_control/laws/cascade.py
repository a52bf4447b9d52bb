"""
The paper's cascade (`lta_control.cascade`), as a law among others.

In one process it runs together with the estimator (`lta_control.onboard`), which gives the same
to the last bit.
"""

from typing import NamedTuple

from lta_control.allocation import Rotors, Scratch
from lta_control.carried import measured
from lta_control.cascade import CascadeGains
from lta_control.control import control_step, ControlMemory
from lta_control.laws.protocol import Command, Feedback, Heard, Law, UNMOVED
from lta_control.vehicle_side import rotors_of, surge_drag_of
from lta_model.vehicle import Vehicle


class CascadeKnown(NamedTuple):
    """Gains, rotors, and drag along body x: linear [N s/m] and quadratic [N s2/m2]."""

    gains: CascadeGains
    rotors: Rotors
    surge_drag: tuple[float, float]


class CascadeState(NamedTuple):
    """The newest command and what control remembers."""

    command: Command = Command()
    control: ControlMemory = ControlMemory()


def known(gains: CascadeGains, vehicle: Vehicle) -> CascadeKnown:
    """Return what stays the same during a flight."""
    return CascadeKnown(gains, rotors_of(vehicle), surge_drag_of(vehicle))


def step(
    constants: CascadeKnown, memory: CascadeState, heard: Heard, scratch: Scratch
) -> CascadeState:
    """Return the memory one step later, with the new command in it."""
    motion = heard.motion
    duties, control = control_step(
        constants.gains,
        constants.rotors,
        constants.surge_drag,
        memory.control,
        measured(motion.attitude, motion.position[2], motion.velocity, motion.rates),
        heard.setpoint,
        heard.dt,
        scratch,
    )
    return CascadeState(Command(duties, UNMOVED), control)


LAW = Law('cascade', CascadeGains, Feedback.ESTIMATOR, known, CascadeState(), step)
