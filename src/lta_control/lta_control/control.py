"""
One step of control: from estimate and setpoint to duties.

The cascade asks, the allocation gives what the rotors can, and what is missing goes back to the
cascade, so that no integral winds up against a rotor at its limit.
"""

from typing import NamedTuple

from lta_control.allocation import allocate, Rotors, Scratch, thrusts_to_duties
from lta_control.cascade import (
    cascade_step,
    CascadeGains,
    CascadeMeasurement,
    CascadeMemory,
    Setpoint,
    WrenchDemand,
)
from lta_control.per_rotor import NONE, PerRotor

FOOT = 0.03  # m above its standing height that still count as standing
STILL = 0.05  # m/s
TILT_LIMIT = 1.0  # rad; beyond it the drone has turned over and the motors stop


class ControlMemory(NamedTuple):
    """What control remembers from step to step."""

    cascade: CascadeMemory = CascadeMemory()
    thrusts: PerRotor = NONE
    shortfall: WrenchDemand = WrenchDemand(0.0, 0.0, 0.0)


def control_step(
    gains: CascadeGains,
    rotors: Rotors,
    surge_drag: tuple[float, float],
    memory: ControlMemory,
    measured: CascadeMeasurement,
    setpoint: Setpoint,
    dt: float,
    scratch: Scratch,
) -> tuple[PerRotor, ControlMemory]:
    """
    Return the duty of each slot and the new memory.

    Parameters
    ----------
    gains : CascadeGains
        Of all loops.
    rotors : Rotors
        What the rotors can do.
    surge_drag : tuple
        Linear [N s/m] and quadratic [N s2/m2] drag along body x.
    memory : ControlMemory
        From the last step.
    measured, setpoint : Measured, Setpoint
        Where the drone is and where it should be.
    dt : float
        Time since the last step. [s]
    scratch : sequence of float
        Numbers that the allocation may write on.

    """
    demand, cascade = cascade_step(
        gains,
        surge_drag,
        rotors.lowest_heave,
        rotors.sink,
        memory.cascade,
        measured,
        setpoint,
        memory.shortfall,
        dt,
    )
    wrench = (demand.surge, 0.0, demand.heave, 0.0, 0.0, demand.yaw)
    thrusts, given = allocate(rotors, wrench, memory.thrusts, scratch)
    shortfall = WrenchDemand(
        given[0] - demand.surge, given[2] - demand.heave, given[5] - demand.yaw
    )
    return thrusts_to_duties(rotors, thrusts), ControlMemory(cascade, thrusts, shortfall)


def has_landed(measured: CascadeMeasurement, setpoint: Setpoint, standing_height: float) -> bool:
    """
    Tell whether the drone stands on the floor and is asked to be no higher.

    Parameters
    ----------
    measured, setpoint : Measured, Setpoint
        Where the drone is and where it should be.
    standing : float
        Altitude of the hull centre when the drone stands. [m]

    """
    down = measured.altitude < standing_height + FOOT and abs(measured.climb) < STILL
    return down and setpoint.altitude <= standing_height


def step_duration(last_ns: int | None, now_ns: int, period_ns: int) -> float:
    """
    Return the time for one step: between the stamps, up to ten periods. [s]

    Best-effort messages may be lost, and a first one has none before it. One that is no newer than
    the last counts as a tenth of a period: time must go on, but hardly.
    """
    if last_ns is None:
        return period_ns * 1e-9
    return min(max(now_ns - last_ns, period_ns // 10), 10 * period_ns) * 1e-9
