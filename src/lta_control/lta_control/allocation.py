"""
From a wanted force and moment to rotor thrusts, and from thrusts to duties.

The thrusts t minimise sum_i w_i (B t - wrench)_i^2 with low <= t <= high: when the rotors cannot
do everything, the weights say what gives way first. Solved exactly by an active set (Nocedal and
Wright 2006, Numerical Optimization, section 16.5) from the last solution: rotors at a limit are
held there while the others take the best step. For up to eight rotors this needs no library and
compiles, for a graphics card as well: what changes on the way stands in numbers that the caller
lends, row after row.
"""

from collections.abc import MutableSequence
import math
from typing import NamedTuple

from lta_control.per_rotor import PerRotor, SLOTS
import numpy as np
from numpy.typing import NDArray

AXES = 6

ROUNDS = 60  # at most; four rotors from anywhere need fewer than a dozen
RIDGE = 1e-9  # of the mean stiffness: what no weighted axis feels stays as it is
INWARD = 1e-12  # pull away from a limit that counts as one [N]

# Where each part stands in the scratch numbers; the first two are matrices of SLOTS by SLOTS.
STIFFNESS = 0
ROWS = 64
TARGET = 128
PULL = 136
RIGHT = 144
STEP = 152
THRUSTS = 160
FREE = 168  # 1 where a rotor is away from its limits, else 0
GIVEN = 176
SCRATCH = 182

Wrench = tuple[float, float, float, float, float, float]
Column = tuple[float, float, float, float, float, float]
Columns = tuple[Column, Column, Column, Column, Column, Column, Column, Column]
Scratch = MutableSequence[float] | NDArray[np.float64]


# Altitude before heading before speed; roll only so that the two vertical rotors share the load.
# Moments are scaled by a 0.1 m arm so that all weights compare newtons.
WEIGHTS: Wrench = (1.0, 0.0, 100.0, 10.0, 0.0, 1000.0)
ALIKE: PerRotor = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)


class Rotors(NamedTuple):
    """
    The thrust side of a vehicle, as the allocation needs it; rotors first, then empty slots.

    Attributes
    ----------
    number : int
        Rotors, 1 to 8.
    allocation : tuple of tuple of float
        B: one column a slot, wrench (fx, fy, fz, mx, my, mz) per newton of thrust. [N/N, m]
    low, high : tuple of float
        Thrust limits by slot. [N]
    lowest_heave : float
        Strongest push downwards by the rotors that point up. [N]
    sink : float
        Heave that comes with a newton of surge from the rotors that push on. [N/N]
    a, b : tuple of float
        Thrust curve T = a u^2 + b u by slot, u = duty (paper section on thrust). [N]
    reverse : tuple of float
        Thrust at a reversed duty per thrust at the same duty forward, by slot. [1]
    weights : tuple of float
        w, by axis.

    """

    number: int
    allocation: Columns
    low: PerRotor
    high: PerRotor
    lowest_heave: float
    a: PerRotor
    b: PerRotor
    reverse: PerRotor = ALIKE
    weights: Wrench = WEIGHTS
    sink: float = 0.0


def create_scratch() -> list[float]:
    """Return numbers that the allocation may write on; it expects nothing of what they hold."""
    return [0.0] * SCRATCH


def allocate(
    rotors: Rotors, wrench: Wrench, start: PerRotor, scratch: Scratch
) -> tuple[PerRotor, Wrench]:
    """
    Return rotor thrusts and the wrench they give.

    Parameters
    ----------
    rotors : Rotors
        B and thrust limits.
    wrench : tuple
        Wanted force and moment about the hull centre, body frame. [N, N m]
    start : tuple
        Thrusts of the last step by slot, where the search begins. [N]
    scratch : sequence of float
        At least `SCRATCH` numbers to write on.

    """
    s, count, low, high = scratch, rotors.number, rotors.low, rotors.high
    _write_problem(rotors, wrench, start, s)
    for _ in range(ROUNDS):
        _write_gradient(count, s)
        _solve_step(count, s)
        share, stop = _limit_step(rotors, s)
        for j in range(count):
            moved = s[THRUSTS + j] + share * s[STEP + j]
            s[THRUSTS + j] = min(max(moved, low[j]), high[j])
        if stop >= 0:
            s[THRUSTS + stop] = high[stop] if s[STEP + stop] > 0.0 else low[stop]
            s[FREE + stop] = 0.0
            continue
        _write_gradient(count, s)
        stop = _find_rotor_to_free(rotors, s)
        if stop < 0:
            break
        s[FREE + stop] = 1.0
    return _read_solution(rotors, s)


def _write_problem(rotors: Rotors, wrench: Wrench, start: PerRotor, s: Scratch) -> None:
    """Write the problem: stiffness, target, thrusts within their limits, and which are free."""
    count, columns, low, high = rotors.number, rotors.allocation, rotors.low, rotors.high
    weights, ridge = rotors.weights, 0.0
    for j in range(count):
        for k in range(count):
            s[STIFFNESS + SLOTS * j + k] = _weighted_product(weights, columns[j], columns[k])
        ridge += RIDGE * s[STIFFNESS + SLOTS * j + j] / count
    for j in range(count):
        thrust = min(max(start[j], low[j]), high[j])
        s[THRUSTS + j] = thrust
        s[TARGET + j] = _weighted_product(weights, columns[j], wrench) + ridge * thrust
        s[STIFFNESS + SLOTS * j + j] += ridge
        s[FREE + j] = 1.0 if low[j] < thrust < high[j] else 0.0


def _write_gradient(count: int, s: Scratch) -> None:
    """Write minus the gradient: where each thrust would go."""
    for j in range(count):
        pull = s[TARGET + j]
        for i in range(count):
            pull -= s[STIFFNESS + SLOTS * j + i] * s[THRUSTS + i]
        s[PULL + j] = pull


def _solve_step(count: int, s: Scratch) -> None:
    """Write the step to the minimum over the free thrusts; 0 for the others (elimination)."""
    for j in range(count):
        s[RIGHT + j] = s[PULL + j]
        s[STEP + j] = 0.0
        for i in range(count):
            s[ROWS + SLOTS * j + i] = s[STIFFNESS + SLOTS * j + i]
    for j in range(count):
        pivot = s[ROWS + SLOTS * j + j]
        for k in range(j + 1, count):
            if s[FREE + j] > 0.0 and s[FREE + k] > 0.0 and pivot > 0.0:
                factor = s[ROWS + SLOTS * k + j] / pivot
                s[RIGHT + k] -= factor * s[RIGHT + j]
                for i in range(j, count):
                    s[ROWS + SLOTS * k + i] -= factor * s[ROWS + SLOTS * j + i]
    for j in range(count - 1, -1, -1):
        pivot = s[ROWS + SLOTS * j + j]
        if s[FREE + j] > 0.0 and pivot > 0.0:
            rest = s[RIGHT + j]
            for i in range(j + 1, count):
                rest -= s[ROWS + SLOTS * j + i] * s[STEP + i]
            s[STEP + j] = rest / pivot


def _limit_step(rotors: Rotors, s: Scratch) -> tuple[float, int]:
    """Return the share of a step that no limit forbids, and the rotor at whose it ends or -1."""
    share, stop = 1.0, -1
    for j in range(rotors.number):
        step = s[STEP + j]
        limit = rotors.high[j] if step > 0.0 else rotors.low[j]
        if share * abs(step) > abs(limit - s[THRUSTS + j]):
            share, stop = abs(limit - s[THRUSTS + j]) / abs(step), j
    return share, stop


def _find_rotor_to_free(rotors: Rotors, s: Scratch) -> int:
    """Return the rotor that most wants to leave its limit, or -1."""
    most, found = INWARD, -1
    for j in range(rotors.number):
        stiffness = s[STIFFNESS + SLOTS * j + j]
        if s[FREE + j] > 0.0 or stiffness <= 0.0:
            continue
        inward = s[PULL + j] if s[THRUSTS + j] <= rotors.low[j] else -s[PULL + j]
        if inward / stiffness > most:
            most, found = inward / stiffness, j
    return found


def _read_solution(rotors: Rotors, s: Scratch) -> tuple[PerRotor, Wrench]:
    """Return the thrusts, 0 in empty slots, and B times them."""
    for axis in range(AXES):
        s[GIVEN + axis] = 0.0
    for j in range(rotors.number):
        for axis in range(AXES):
            s[GIVEN + axis] += rotors.allocation[j][axis] * s[THRUSTS + j]
    for j in range(rotors.number, SLOTS):
        s[THRUSTS + j] = 0.0
    t, g = THRUSTS, GIVEN
    # Tuples of fixed length, so that this compiles.
    return (s[t], s[t + 1], s[t + 2], s[t + 3], s[t + 4], s[t + 5], s[t + 6], s[t + 7]), (
        s[g], s[g + 1], s[g + 2], s[g + 3], s[g + 4], s[g + 5],
    )  # fmt: skip


def _weighted_product(weights: Wrench, p: Column, q: Column) -> float:
    total = 0.0
    for axis in range(AXES):
        total += weights[axis] * p[axis] * q[axis]
    return total


def thrust_to_duty(thrust: float, a: float, b: float) -> float:
    """
    Return the duty that gives a thrust: the inverse of T = a u^2 + b u, odd in T.

    Parameters
    ----------
    thrust : float
        Wanted thrust. [N]
    a, b : float
        Thrust curve. [N]

    """
    size = abs(thrust)
    root = math.sqrt(b * b + 4.0 * a * size)
    # The rationalised form: no cancellation at small thrusts, and a = 0 is allowed.
    return math.copysign(2.0 * size / (b + root), thrust) if size > 0.0 else 0.0


def thrusts_to_duties(rotors: Rotors, thrusts: PerRotor) -> PerRotor:
    """Return the duty of each slot that gives its thrust. [N] to [1]."""
    return (
        _slot_duty(rotors, thrusts[0], 0),
        _slot_duty(rotors, thrusts[1], 1),
        _slot_duty(rotors, thrusts[2], 2),
        _slot_duty(rotors, thrusts[3], 3),
        _slot_duty(rotors, thrusts[4], 4),
        _slot_duty(rotors, thrusts[5], 5),
        _slot_duty(rotors, thrusts[6], 6),
        _slot_duty(rotors, thrusts[7], 7),
    )


def _slot_duty(rotors: Rotors, thrust: float, slot: int) -> float:
    forward = thrust if thrust >= 0.0 else thrust / rotors.reverse[slot]
    return thrust_to_duty(forward, rotors.a[slot], rotors.b[slot])
