"""
No feedback at all: the duties that would hold the setpoint if nothing ever lagged behind.

The seed paper flies Zufferey's model by inputs that it does not print. Here they follow from the
vehicle's own drag and weight, at rest in the wanted motion:

    surge = (d_x + q_x |v|) v,   heave = weight + (d_z + q_z |c|) c,   yaw = (d_r + q_r |r|) r

v is the forward speed asked for; altitude and heading are asked for as a climb rate c and a turn
rate r for as long as they would take. Inertia is left out, and so is all that is measured: it
arrives late, coasts on, and never learns where it is.
"""

from typing import NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_config.settings import setting, Settings
from lta_control.allocation import allocate, duties, Rotors, Scratch
from lta_control.cascade import drag_force, wrap
from lta_control.laws.frames import limited
from lta_control.laws.protocol import Command, Feedback, Heard, Law, UNMOVED
from lta_control.per_rotor import NONE, PerRotor
from lta_control.vehicle_side import rotors_of
from lta_model.vehicle import Vehicle


class OpenLoopGains(Settings):
    """Rates at which altitude and heading are asked to change."""

    climb_rate: float = setting(..., 'Climb or sink rate.', unit='m/s', low=0.001, high=2.0)
    turn_rate: float = setting(..., 'Turn rate.', unit='rad/s', low=0.001, high=6.0)


class OpenLoopKnown(NamedTuple):
    """Gains, rotors, drag of surge, heave and yaw (linear, quadratic), weight [N], start [m]."""

    gains: OpenLoopGains
    rotors: Rotors
    surge: tuple[float, float]
    heave: tuple[float, float]
    yaw: tuple[float, float]
    weight: float
    standing: float


class OpenLoopState(NamedTuple):
    """The newest command, and where the vehicle would be if it were prompt."""

    command: Command = Command()
    begun: bool = False
    altitude: float = 0.0  # [m]
    heading: float = 0.0  # [rad]
    thrusts: PerRotor = NONE


def known(gains: OpenLoopGains, vehicle: Vehicle) -> OpenLoopKnown:
    """Return what stays the same during a flight."""
    linear, quadratic = vehicle.file.aero.linear_drag, vehicle.file.aero.quadratic_drag
    return OpenLoopKnown(
        gains,
        rotors_of(vehicle),
        (linear.force.vector[0], quadratic.force.vector[0]),
        (linear.force.vector[2], quadratic.force.vector[2]),
        (linear.moment.vector[2], quadratic.moment.vector[2]),
        vehicle.heaviness * STANDARD_GRAVITY,
        vehicle.standing_height,
    )


def step(
    constants: OpenLoopKnown, memory: OpenLoopState, heard: Heard, scratch: Scratch
) -> OpenLoopState:
    """Return the memory one step later, with the new command in it; motion is not looked at."""
    gains, setpoint, dt = constants.gains, heard.setpoint, heard.dt
    altitude = memory.altitude if memory.begun else constants.standing
    heading = memory.heading
    climb = limited((setpoint.altitude - altitude) / dt, gains.climb_rate)
    turn = limited(wrap(setpoint.heading - heading) / dt, gains.turn_rate)
    wrench = (
        drag_force(constants.surge[0], constants.surge[1], setpoint.speed),
        0.0,
        constants.weight + drag_force(constants.heave[0], constants.heave[1], climb),
        0.0,
        0.0,
        drag_force(constants.yaw[0], constants.yaw[1], turn),
    )
    thrusts, _ = allocate(constants.rotors, wrench, memory.thrusts, scratch)
    command = Command(duties(constants.rotors, thrusts), UNMOVED)
    return OpenLoopState(command, True, altitude + dt * climb, wrap(heading + dt * turn), thrusts)


LAW = Law('open_loop', OpenLoopGains, Feedback.ESTIMATOR, known, OpenLoopState(), step)
