"""
The truth simulator's integrator, command path, pilot and battery.

The integrator is the fifth-order step of Dormand and Prince, at most 5 ms long. Steps end where a
command arrives, so that delays are exact. The rotation matrix is orthonormalised every tick.

The pilot is independent of LTA's controllers. It controls height, heading and forward speed with
proportional, integral and rate terms on noisy measurements, and allocates by the pseudo-inverse of
the nominal allocation matrix. The excitation is added to its commands.
"""

import math
from typing import Final, NamedTuple

from lta_challenge.truth_equations import (
    Array,
    TruthConstants,
    TruthKernel,
    TruthWork,
    write_slope,
    write_speeds,
)
from lta_model.state import VOLTAGE

TICK: Final = 0.01  # s; period of the pilot and of the stored samples
LONGEST: Final = 0.005  # s; largest integrator step
# Columns of a stored sample: position 3, rotation 9, velocity 3, rates 3, thrust 8, wrench of
# effects outside the library 6, voltage 1; 5 are unused
SAMPLE_SIZE: Final = 38


class PilotConstants(NamedTuple):
    """The pilot and what it assumes about the vehicle."""

    # Of height, climb, sum of the heights, hover force; heading, yaw rate; speed, drag, shape (8,)
    gains: Array
    # Thrust of each rotor per force forward and up, and per moment about the vertical, shape
    # (rotors, 3)
    mixing: Array
    curve: Array  # nominal thrust curve, shape (2,)
    limits: Array  # of a commanded wrench, shape (6,) [N, N m]


class PilotInputs(NamedTuple):
    """Inputs of the pilot for one flight."""

    # Height [m], heading [rad] and forward speed [m/s] at each tick, shape (n, 3)
    setpoints: Array
    noise: Array  # measurement noise of height, heading and speed, shape (n, 3)
    # Excitation added to duties [1], or to a wrench, relative to its limits, shape (n, 8)
    shaken: Array
    pushed: bool = False  # whether the commands are wrenches instead of duties


def dormand_prince_step(
    kernel: TruthKernel, y: Array, h: float, hull: TruthConstants, work: TruthWork
) -> None:
    """Advance the state by h [s]: Dormand and Prince 1980, fifth order."""
    stages = work.stages
    k1, k2, k3, k4, k5, k6, at = (
        stages[0], stages[1], stages[2], stages[3], stages[4], stages[5], stages[6],
    )  # fmt: skip
    write_slope(kernel, y, k1, hull, work)
    for i in range(kernel.size):
        at[i] = y[i] + h * (1 / 5) * k1[i]
    write_slope(kernel, at, k2, hull, work)
    for i in range(kernel.size):
        at[i] = y[i] + h * (3 / 40 * k1[i] + 9 / 40 * k2[i])
    write_slope(kernel, at, k3, hull, work)
    for i in range(kernel.size):
        at[i] = y[i] + h * (44 / 45 * k1[i] - 56 / 15 * k2[i] + 32 / 9 * k3[i])
    write_slope(kernel, at, k4, hull, work)
    for i in range(kernel.size):
        at[i] = y[i] + h * (
            19372 / 6561 * k1[i] - 25360 / 2187 * k2[i] + 64448 / 6561 * k3[i] - 212 / 729 * k4[i]
        )
    write_slope(kernel, at, k5, hull, work)
    for i in range(kernel.size):
        at[i] = y[i] + h * (
            9017 / 3168 * k1[i] - 355 / 33 * k2[i] + 46732 / 5247 * k3[i]
            + 49 / 176 * k4[i] - 5103 / 18656 * k5[i]
        )  # fmt: skip
    write_slope(kernel, at, k6, hull, work)
    for i in range(kernel.size):
        y[i] += h * (
            35 / 384 * k1[i] + 500 / 1113 * k3[i] + 125 / 192 * k4[i]
            - 2187 / 6784 * k5[i] + 11 / 84 * k6[i]
        )  # fmt: skip


def orthonormalize_rotation(y: Array, n: Array) -> None:
    """Bring the rotation matrix back to a rotation: R (3 - R' R) / 2; `n` is work space."""
    for i in range(3):
        for j in range(3):
            n[i, j] = 0.0
            for k in range(3):
                n[i, j] -= 0.5 * y[3 + 3 * k + i] * y[3 + 3 * k + j]
        n[i, i] += 1.5
    for i in range(3):
        a, b, c = y[3 + 3 * i], y[4 + 3 * i], y[5 + 3 * i]
        for j in range(3):
            y[3 + 3 * i + j] = a * n[0, j] + b * n[1, j] + c * n[2, j]


def demanded_wrench(
    y: Array, s: Array, setpoints: Array, noise: Array, gains: Array, height_sum: Array
) -> tuple[float, float, float]:
    """Return the force forward and up and the moment about the vertical that the pilot demands."""
    height, heading, speed = y[2] + noise[0], math.atan2(y[6], y[3]) + noise[1], s[0] + noise[2]
    climb = y[9] * s[0] + y[10] * s[1] + y[11] * s[2] + noise[2]
    off = setpoints[0] - height
    if abs(off) < 0.6:
        height_sum[0] = min(max(height_sum[0] + TICK * off, -8.0), 8.0)
    up = gains[0] * off - gains[1] * climb + gains[2] * height_sum[0] + gains[3]
    turn = (setpoints[1] - heading + math.pi) % (2.0 * math.pi) - math.pi
    around = gains[4] * min(max(turn, -1.0), 1.0) - gains[5] * s[5]
    ahead = gains[6] * (setpoints[2] - speed) + gains[7] * abs(setpoints[2]) * setpoints[2]
    return ahead, up, around


def duty_for_thrust(thrust: float, curve: Array) -> float:
    """Return the duty for a thrust by the nominal curve; these rotors do not reverse."""
    if thrust <= 0.0:
        return 0.0
    a, b = curve[0], curve[1]
    return float((math.sqrt(b * b + 4.0 * a * thrust) - b) / (2.0 * a))


def write_command(
    kernel: TruthKernel,
    y: Array,
    hull: TruthConstants,
    pilot: PilotConstants,
    series: PilotInputs,
    k: int,
    work: TruthWork,
    out: Array,
) -> None:
    """Write the command of the pilot at tick k: duties, or a wrench."""
    ahead, up, around = demanded_wrench(
        y, work.speeds, series.setpoints[k], series.noise[k], pilot.gains, work.height_sum
    )
    shaken, limits = series.shaken[k], pilot.limits
    for j in range(out.shape[0]):
        out[j] = 0.0
    if hull.pushed:
        wrench = (ahead, 0.0, up, 0.0, 0.0, around)
        for j in range(6):
            out[j] = min(max(wrench[j] + shaken[j] * limits[j], -limits[j]), limits[j])
        return
    mixing = pilot.mixing
    for j in range(kernel.rotors):
        thrust = mixing[j, 0] * ahead + mixing[j, 1] * up + mixing[j, 2] * around
        out[j] = min(max(duty_for_thrust(thrust, pilot.curve) + shaken[j], 0.0), 1.0)


def write_sample(y: Array, hull: TruthConstants, work: TruthWork, out: Array) -> None:
    """Write the sample of a tick, see `SAMPLE_SIZE`."""
    for j in range(12):
        out[j] = y[j]
    for j in range(6):
        out[12 + j] = work.speeds[j]
        out[26 + j] = work.strange[j]
    for j in range(8):
        out[18 + j] = work.thrusts[j] if not hull.pushed else work.command[j]
    out[32] = hull.surroundings[VOLTAGE]


def fly_truth(
    kernel: TruthKernel,
    y: Array,
    hull: TruthConstants,
    pilot: PilotConstants,
    series: PilotInputs,
    delay: float,
    cell: Array,
    longest: float,
    work: TruthWork,
    commands: Array,
    samples: Array,
) -> None:
    """
    Fly, and store the commands and a sample at each tick.

    `cell` is the voltage when full and at rest, its loss per duty and second, and per duty;
    `delay` is that of a command [s], and `longest` the largest integrator step [s].
    """
    spent, tick, newest = 0.0, TICK, -1
    command = work.command
    for k in range(samples.shape[0]):
        now = k * tick
        write_speeds(kernel, y, hull, work.speeds)
        write_command(kernel, y, hull, pilot, series, k, work, commands[k])
        load = 0.0
        for j in range(kernel.rotors):
            load += commands[k, j] if not hull.pushed else 0.1
        spent += load * tick
        hull.surroundings[VOLTAGE] = cell[0] - cell[1] * spent - cell[2] * load
        end = now + tick
        while True:
            # A command that has arrived holds until the next arrives
            while newest + 1 <= k and (newest + 1) * tick + delay <= now + 1e-9:
                newest += 1
            for j in range(8):
                command[j] = commands[newest, j] if newest >= 0 else 0.0
            if now == k * tick:
                write_slope(kernel, y, work.stages[0], hull, work)
                write_sample(y, hull, work, samples[k])
            until = end
            coming = (newest + 1) * tick + delay
            if newest + 1 <= k and coming < end - 1e-9:
                until = coming
            # Rounded up; 1e-9 absorbs rounding
            count = math.ceil((until - now) / longest - 1e-9)
            for _ in range(count):
                dormand_prince_step(kernel, y, (until - now) / count, hull, work)
            now = until
            if now >= end - 1e-9:
                break
        orthonormalize_rotation(y, work.square)
