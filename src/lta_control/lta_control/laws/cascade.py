"""
The paper's cascade (`lta_control.cascade`) as a control law.

The one-process loop runs it together with the estimator (`lta_control.onboard`), with
bit-identical results.
"""

from typing import NamedTuple

from lta_control.allocation import Rotors, Scratch
from lta_control.cascade import CascadeGains
from lta_control.control import control_step, ControlMemory
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs, UNMOVED
from lta_control.message_rounding import build_measurement
from lta_control.vehicle_parameters import build_rotors, surge_drag_coefficients
from lta_model.vehicle import Vehicle


class CascadeLawConstants(NamedTuple):
    """Gains, rotors, and drag along body x: linear [N s/m] and quadratic [N s2/m2]."""

    gains: CascadeGains
    rotors: Rotors
    surge_drag: tuple[float, float]


class CascadeLawMemory(NamedTuple):
    """The latest command and the controller state."""

    command: LawCommand = LawCommand()
    control: ControlMemory = ControlMemory()


def build_constants(gains: CascadeGains, vehicle: Vehicle) -> CascadeLawConstants:
    """Return the values that stay constant during a flight."""
    return CascadeLawConstants(gains, build_rotors(vehicle), surge_drag_coefficients(vehicle))


def step(
    constants: CascadeLawConstants, memory: CascadeLawMemory, inputs: LawInputs, scratch: Scratch
) -> CascadeLawMemory:
    """Return the memory one step later, with the new command in it."""
    motion = inputs.motion
    duties, control = control_step(
        constants.gains,
        constants.rotors,
        constants.surge_drag,
        memory.control,
        build_measurement(motion.attitude, motion.position[2], motion.velocity, motion.rates),
        inputs.setpoint,
        inputs.dt,
        scratch,
    )
    return CascadeLawMemory(LawCommand(duties, UNMOVED), control)


LAW = ControlLaw(
    'cascade', CascadeGains, Feedback.ESTIMATOR, build_constants, CascadeLawMemory(), step
)
