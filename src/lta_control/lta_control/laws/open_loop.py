# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Open-loop control: the duties that would hold the setpoint in steady motion.

The seed paper flies Zufferey's model with inputs that it does not print. Here they follow from
the vehicle's own drag and weight, in equilibrium at the wanted motion:

    surge = (d_x + q_x |v|) v,   heave = weight + (d_z + q_z |c|) c,   yaw = (d_r + q_r |r|) r

v is the commanded forward speed. Altitude and heading are commanded as a climb rate c and a turn
rate r for the time that the change takes. Inertia and all measurements are ignored: the vehicle
lags, coasts on, and never corrects its position.
"""

from typing import NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.settings import setting, Settings
from lta_control.allocation import deliver_wrench, NO_ROTORS, PerRotor, Rotors, Scratch
from lta_control.laws.cascade import clamp_symmetric
from lta_control.laws.protocol import ControlLaw, Feedback, LawCommand, LawInputs, UNMOVED
from lta_control.motion import drag_force, wrap_angle
from lta_control.vehicle_parameters import build_rotors
from lta_model.vehicle import Vehicle


class OpenLoopGains(Settings):
    """Commanded rates of altitude and heading."""

    climb_rate: float = setting(..., 'm/s', 0.001, 2.0)
    """Commanded climb or sink rate."""
    turn_rate: float = setting(..., 'rad/s', 0.001, 6.0)
    """Commanded turn rate."""


class OpenLoopLawConstants(NamedTuple):
    """Gains, rotors, drag of surge, heave and yaw (linear, quadratic), weight [N], start [m]."""

    gains: OpenLoopGains
    rotors: Rotors
    surge: tuple[float, float]
    heave: tuple[float, float]
    yaw: tuple[float, float]
    weight: float
    standing: float


class OpenLoopLawMemory(NamedTuple):
    """The latest command, and the altitude and heading of an ideal vehicle without lag."""

    command: LawCommand = LawCommand()
    begun: bool = False
    altitude: float = 0.0  # [m]
    heading: float = 0.0  # [rad]
    thrusts: PerRotor = NO_ROTORS


def build_constants(gains: OpenLoopGains, vehicle: Vehicle) -> OpenLoopLawConstants:
    """Return the values that stay constant during a flight."""
    linear, quadratic = vehicle.file.aero.linear_drag, vehicle.file.aero.quadratic_drag
    return OpenLoopLawConstants(
        gains,
        build_rotors(vehicle),
        (linear.force.vector[0], quadratic.force.vector[0]),
        (linear.force.vector[2], quadratic.force.vector[2]),
        (linear.moment.vector[2], quadratic.moment.vector[2]),
        vehicle.heaviness * STANDARD_GRAVITY,
        vehicle.hull_height_on_floor,
    )


def step(
    constants: OpenLoopLawConstants, memory: OpenLoopLawMemory, inputs: LawInputs, scratch: Scratch
) -> OpenLoopLawMemory:
    """Return the memory one step later, with the new command in it; the motion is not used."""
    gains, setpoint, dt = constants.gains, inputs.setpoint, inputs.dt
    # The planned altitude starts on the floor.
    altitude = memory.altitude if memory.begun else constants.standing
    heading = memory.heading
    # Full rate until the last step, which ends exactly at the setpoint
    climb = clamp_symmetric((setpoint.altitude - altitude) / dt, gains.climb_rate)
    turn = clamp_symmetric(wrap_angle(setpoint.heading - heading) / dt, gains.turn_rate)
    wrench = (
        drag_force(constants.surge[0], constants.surge[1], setpoint.speed),
        0.0,
        constants.weight + drag_force(constants.heave[0], constants.heave[1], climb),
        0.0,
        0.0,
        drag_force(constants.yaw[0], constants.yaw[1], turn),
    )
    duties, thrusts, _ = deliver_wrench(constants.rotors, wrench, memory.thrusts, scratch)
    command = LawCommand(duties, UNMOVED)
    return OpenLoopLawMemory(
        command, True, altitude + dt * climb, wrap_angle(heading + dt * turn), thrusts
    )


OPEN_LOOP_LAW = ControlLaw(
    'open_loop', OpenLoopGains, Feedback.ESTIMATOR, build_constants, OpenLoopLawMemory(), step
)
