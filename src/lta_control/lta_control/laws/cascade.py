# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The paper's cascade (`lta_control.cascade`) as a control law.

The cascade demands a wrench and the allocation delivers what the rotors can. The shortfall goes
back to the cascade, so that no integral winds up while a rotor is at its limit.
"""

from typing import NamedTuple

from lta_control.allocation import deliver_wrench, NO_ROTORS, PerRotor, Rotors, Scratch
from lta_control.cascade import (
    build_measurement,
    cascade_step,
    CascadeGains,
    CascadeMeasurement,
    CascadeMemory,
    Setpoint,
    WrenchDemand,
)
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs, UNMOVED
from lta_control.vehicle_parameters import build_rotors, surge_drag_coefficients
from lta_model.vehicle import Vehicle


class CascadeLawConstants(NamedTuple):
    """Gains, rotors, and drag along body x: linear [N s/m] and quadratic [N s2/m2]."""

    gains: CascadeGains
    rotors: Rotors
    surge_drag: tuple[float, float]


class CascadeLawMemory(NamedTuple):
    """The latest command, the cascade, thrusts [N], and delivered minus demanded wrench."""

    command: LawCommand = LawCommand()
    cascade: CascadeMemory = CascadeMemory()
    thrusts: PerRotor = NO_ROTORS
    shortfall: WrenchDemand = WrenchDemand(0.0, 0.0, 0.0)


def build_constants(gains: CascadeGains, vehicle: Vehicle) -> CascadeLawConstants:
    """Return the values that stay constant during a flight."""
    return CascadeLawConstants(gains, build_rotors(vehicle), surge_drag_coefficients(vehicle))


def step(
    constants: CascadeLawConstants, memory: CascadeLawMemory, inputs: LawInputs, scratch: Scratch
) -> CascadeLawMemory:
    """Return the memory one step later, with the new command in it."""
    motion = inputs.motion
    measured = build_measurement(
        motion.attitude, motion.position[2], motion.velocity, motion.rates
    )
    return control_step(constants, memory, measured, inputs.setpoint, inputs.dt, scratch)


def control_step(
    constants: CascadeLawConstants,
    memory: CascadeLawMemory,
    measured: CascadeMeasurement,
    setpoint: Setpoint,
    dt: float,
    scratch: Scratch,
) -> CascadeLawMemory:
    """Return the memory one step later; `dt` since the last step [s], `scratch` of `allocate`."""
    demand, cascade = compute_demand(constants, memory, measured, setpoint, dt)
    return deliver_demand(constants.rotors, demand, cascade, memory.thrusts, scratch)


def compute_demand(
    constants: CascadeLawConstants,
    memory: CascadeLawMemory,
    measured: CascadeMeasurement,
    setpoint: Setpoint,
    dt: float,
) -> tuple[WrenchDemand, CascadeMemory]:
    """Return the demand of the cascade and its memory."""
    rotors = constants.rotors
    return cascade_step(
        constants.gains,
        constants.surge_drag,
        rotors.lowest_heave,
        rotors.sink,
        memory.cascade,
        measured,
        setpoint,
        memory.shortfall,
        dt,
    )


def deliver_demand(
    rotors: Rotors,
    demand: WrenchDemand,
    cascade: CascadeMemory,
    thrusts: PerRotor,
    scratch: Scratch,
) -> CascadeLawMemory:
    """
    Return the memory with the duties that deliver a demand best.

    `cascade` is the memory of the cascade after this step, `thrusts` those of the last step [N].
    """
    # Surge, heave and yaw only: sway, roll and pitch are not controlled.
    wrench = (demand.surge, 0.0, demand.heave, 0.0, 0.0, demand.yaw)
    duties, thrusts, delivered = deliver_wrench(rotors, wrench, thrusts, scratch)
    # Delivered minus demanded, for the anti-windup of the next step
    shortfall = WrenchDemand(
        delivered[0] - demand.surge, delivered[2] - demand.heave, delivered[5] - demand.yaw
    )
    return CascadeLawMemory(LawCommand(duties, UNMOVED), cascade, thrusts, shortfall)


CASCADE_LAW = ControlLaw(
    'cascade', CascadeGains, Feedback.ESTIMATOR, build_constants, CascadeLawMemory(), step
)
