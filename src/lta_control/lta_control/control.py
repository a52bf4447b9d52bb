"""
Compute the duties from estimate and setpoint.

The cascade demands a wrench and the allocation delivers what the rotors can. The shortfall goes
back to the cascade, so that no integral winds up while a rotor is at its limit.
"""

import math
from typing import NamedTuple

from lta_control.allocation import deliver_wrench, Rotors, Scratch
from lta_control.attitude import Quaternion, up_in_body
from lta_control.cascade import (
    cascade_step,
    CascadeGains,
    CascadeMeasurement,
    CascadeMemory,
    Setpoint,
    WrenchDemand,
)
from lta_control.per_rotor import NONE, PerRotor

FOOT = 0.03  # m; tolerance above the standing height
STILL = 0.05  # m/s
STANDSTILL = 6.0  # s without sinking after which a landing has ended
SINKING = 0.02  # m below the lowest height; less is no descent
NO_HEIGHT = 1e6  # m; above all heights
RISING = 0.1  # m above the lowest height; the drone flies again
TILT_LIMIT = 1.0  # rad; beyond it the drone counts as overturned and the motors stop


class ControlMemory(NamedTuple):
    """Controller state between steps."""

    cascade: CascadeMemory = CascadeMemory()
    thrusts: PerRotor = NONE
    shortfall: WrenchDemand = WrenchDemand(0.0, 0.0, 0.0)


class LandingWatch(NamedTuple):
    """Progress of a landing, which does not depend on an exact height."""

    lowest: float = NO_HEIGHT  # since the landing began, or the drone rose last [m]
    still: float = 0.0  # time since the drone sank or rose last [s]


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

    `surge_drag` is the linear [N s/m] and quadratic [N s2/m2] drag along body x, `dt` the time
    since the last step [s], `scratch` the working array of `allocate`.
    """
    demand, cascade = compute_demand(gains, rotors, surge_drag, memory, measured, setpoint, dt)
    return deliver_demand(rotors, demand, cascade, memory.thrusts, scratch)


def compute_demand(
    gains: CascadeGains,
    rotors: Rotors,
    surge_drag: tuple[float, float],
    memory: ControlMemory,
    measured: CascadeMeasurement,
    setpoint: Setpoint,
    dt: float,
) -> tuple[WrenchDemand, CascadeMemory]:
    """Return the demand of the cascade and its memory; arguments as in `control_step`."""
    return cascade_step(
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


def deliver_demand(
    rotors: Rotors,
    demand: WrenchDemand,
    cascade: CascadeMemory,
    thrusts: PerRotor,
    scratch: Scratch,
) -> tuple[PerRotor, ControlMemory]:
    """
    Return the duties that deliver a demand best, and the controller's memory.

    `cascade` is the memory of the cascade after this step, `thrusts` those of the last step [N].
    """
    # Surge, heave and yaw only: sway, roll and pitch are not controlled.
    wrench = (demand.surge, 0.0, demand.heave, 0.0, 0.0, demand.yaw)
    duties, thrusts, delivered = deliver_wrench(rotors, wrench, thrusts, scratch)
    # Delivered minus demanded, for the anti-windup of the next step
    shortfall = WrenchDemand(
        delivered[0] - demand.surge, delivered[2] - demand.heave, delivered[5] - demand.yaw
    )
    return duties, ControlMemory(cascade, thrusts, shortfall)


def has_landed(measured: CascadeMeasurement, setpoint: Setpoint, standing_height: float) -> bool:
    """
    Return whether the drone stands on the floor and its setpoint is no higher.

    `standing_height` is the altitude of the hull centre when the drone stands. [m]
    """
    down = measured.altitude < standing_height + FOOT and abs(measured.climb) < STILL
    return down and setpoint.altitude <= standing_height


def watch_landing(
    watch: LandingWatch, altitude: float, is_landing: bool, dt: float
) -> LandingWatch:
    """
    Return the progress of a landing `dt` seconds later.

    An estimated height that is some centimetres too high never reaches the floor. The drone
    then stands where it no longer sinks although it `is_landing`. An unknown height counts as no
    descent. In the air a wrong end lasts until the drone sinks again, as its motors are off.
    """
    if not is_landing:
        return LandingWatch(NO_HEIGHT, 0.0)
    if altitude < watch.lowest - SINKING or altitude > watch.lowest + RISING:
        return LandingWatch(altitude, 0.0)
    return LandingWatch(watch.lowest, watch.still + dt)


def has_overturned(attitude: Quaternion, uprightness: float) -> bool:
    """
    Return whether the drone tilts so far that its motors stop; False if its attitude is NaN.

    `uprightness` is the cosine of the largest tilt.
    """
    return up_in_body(attitude)[2] < uprightness


def is_control_input_finite(measured: CascadeMeasurement, setpoint: Setpoint) -> bool:
    """Return whether all numbers that steer are finite; if not, the motors stop."""
    # A sum is finite only if every term is
    moving = measured.yaw_rate + measured.speed + measured.sway + measured.pitch_rate
    placed = measured.altitude + measured.climb + measured.heading
    return math.isfinite(moving + placed + setpoint.altitude + setpoint.heading + setpoint.speed)


def step_duration(last_ns: int | None, now_ns: int, period_ns: int) -> float:
    """
    Return the duration of one step from two stamps, at most ten periods. [s]

    Best-effort messages may be lost, and the first one has no predecessor: it counts as one
    period. A stamp that is not newer than the last counts as a tenth of a period, so that time
    still advances.
    """
    if last_ns is None:
        return period_ns * 1e-9
    # The upper bound limits the jump of integrals and filters after a long gap
    return min(max(now_ns - last_ns, period_ns // 10), 10 * period_ns) * 1e-9
