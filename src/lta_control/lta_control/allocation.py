# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Allocate a wanted force and moment to rotor thrusts, and convert thrusts to duties.

The thrusts t minimise sum_i w_i (B t - wrench)_i^2 with low <= t <= high. When the rotors cannot
deliver everything, the weights decide which axis loses first. An active-set method (Nocedal and
Wright 2006, Numerical Optimization, section 16.5) solves this exactly, starting from the last
solution: rotors at a limit stay there while the others take the best step. For up to eight rotors
this needs no library. The working numbers are in an array from the caller, so that the code also
compiles for a GPU.

One number per rotor has eight slots: with a fixed length, one compiled form serves every vehicle.
Slots beyond a vehicle's rotors hold 0 and are ignored.
"""

from collections.abc import Iterable, MutableSequence
import math
from typing import cast, NamedTuple

from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

SLOTS = 8

PerRotor = tuple[float, float, float, float, float, float, float, float]
NO_ROTORS: PerRotor = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def is_any_motor_turning(duties: PerRotor) -> bool:
    """Return whether any motor is commanded to turn."""
    total = 0.0
    for j in range(len(duties)):
        total += abs(duties[j])
    return total > 0.0


def pad_to_slots(values: Iterable[float]) -> PerRotor:
    """
    Return up to eight numbers, padded with zeros.

    Raise `BadInput` if there are more than eight.
    """
    numbers = tuple(values)
    if len(numbers) > SLOTS:
        raise BadInput(
            f'The vehicle has {len(numbers)} rotors, but at most {SLOTS} are supported; remove '
            'some from the vehicle file.'
        )
    return cast('PerRotor', numbers + NO_ROTORS[len(numbers) :])


WRENCH_AXES = 6

ALLOCATION_ROUNDS = 60  # iteration limit; four rotors need fewer than a dozen from any start
RIDGE = 1e-9  # of the mean stiffness; keeps thrusts that affect no weighted axis where they are
INWARD = 1e-12  # smallest pull that releases a rotor from its limit [N]

# Offsets into the scratch array; the first two parts are matrices of SLOTS by SLOTS.
STIFFNESS = 0
ROWS_AT = 64
TARGET = 128
PULL = 136
RIGHT = 144
STEP_AT = 152
THRUSTS_AT = 160
FREE_AT = 168  # 1 where a rotor is away from its limits, else 0
WRENCH_AT = 176
DUTIES = 182
DUTY_SCRATCH = 190

Wrench = tuple[float, float, float, float, float, float]
Column = tuple[float, float, float, float, float, float]
Columns = tuple[Column, Column, Column, Column, Column, Column, Column, Column]
Scratch = MutableSequence[float] | NDArray[np.float64]


# Priority: altitude, heading, speed. The small roll weight makes the vertical rotors share load.
# Moments are scaled by a 0.1 m arm so that all weights compare newtons.
WEIGHTS: Wrench = (1.0, 0.0, 100.0, 10.0, 0.0, 1000.0)
EQUAL_WEIGHTS: PerRotor = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)


class Rotors(NamedTuple):
    """Rotor data for the allocation; the rotors come first, unused slots last."""

    number: int  # number of rotors, 1 to 8
    # B: one column per slot, wrench (fx, fy, fz, mx, my, mz) per newton of thrust [N/N, m]
    allocation: Columns
    # Thrust limits by slot [N]
    low: PerRotor
    high: PerRotor
    # Strongest downward force of the vertical rotors; 0 if none pushes down [N]
    lowest_heave: float
    # Thrust curve T = a u^2 + b u by slot, u = duty (paper section on thrust) [N]
    a: PerRotor
    b: PerRotor
    # Reverse thrust divided by forward thrust at the same duty, by slot [1]
    reverse: PerRotor = EQUAL_WEIGHTS
    weights: Wrench = WEIGHTS  # w, by axis
    sink: float = 0.0  # heave per newton of surge, caused by the forward-pushing rotors [N/N]


def create_working_array() -> list[float]:
    """Return a working array for `allocate`; its content does not matter."""
    return [0.0] * DUTY_SCRATCH


def deliver_wrench(
    rotors: Rotors, wrench: Wrench, start: PerRotor, scratch: Scratch
) -> tuple[PerRotor, PerRotor, Wrench]:
    """Return duties, thrusts and produced wrench for a wanted one; arguments as in `allocate`."""
    thrusts, delivered = allocate(rotors, wrench, start, scratch)
    return thrusts_to_duties(rotors, thrusts, scratch), thrusts, delivered


def allocate(
    rotors: Rotors, wrench: Wrench, start: PerRotor, scratch: Scratch
) -> tuple[PerRotor, Wrench]:
    """
    Return rotor thrusts [N] and the wrench that they produce.

    `wrench` is the wanted force and moment about the hull centre in the body frame [N, N m]. The
    search begins at `start`, the thrusts of the last step [N]. `scratch` has at least
    `DUTY_SCRATCH` numbers and is overwritten.
    """
    s, count, low, high = scratch, rotors.number, rotors.low, rotors.high
    # One round: step to the minimum over the free rotors, stop at the first limit on the way
    _write_problem(rotors, wrench, start, s)
    for _ in range(ALLOCATION_ROUNDS):
        _write_gradient(count, s)
        _solve_step(count, s)
        # The feasible share of the step, and the rotor that limits it
        share, stop = 1.0, -1
        for j in range(count):
            room = abs((high[j] if s[STEP_AT + j] > 0.0 else low[j]) - s[THRUSTS_AT + j])
            if share * abs(s[STEP_AT + j]) > room:
                share, stop = room / abs(s[STEP_AT + j]), j
        for j in range(count):
            moved = s[THRUSTS_AT + j] + share * s[STEP_AT + j]
            s[THRUSTS_AT + j] = min(max(moved, low[j]), high[j])
        if stop >= 0:
            # Exactly at the limit, free of rounding, and no longer free to move
            s[THRUSTS_AT + stop] = high[stop] if s[STEP_AT + stop] > 0.0 else low[stop]
            s[FREE_AT + stop] = 0.0
            continue
        _write_gradient(count, s)
        # At the constrained minimum: release a rotor whose multiplier points inward, or finish
        stop = _find_rotor_to_free(rotors, s)
        if stop < 0:
            break
        s[FREE_AT + stop] = 1.0
    return _read_solution(rotors, s)


def _write_problem(rotors: Rotors, wrench: Wrench, start: PerRotor, s: Scratch) -> None:
    """Write stiffness, target, start thrusts within their limits, and the free rotors."""
    count, columns, low, high = rotors.number, rotors.allocation, rotors.low, rotors.high
    weights, ridge = rotors.weights, 0.0
    for j in range(count):
        for k in range(count):
            # Normal equations: B^T W B t = B^T W wrench
            product = 0.0
            for axis in range(WRENCH_AXES):
                product += weights[axis] * columns[j][axis] * columns[k][axis]
            s[STIFFNESS + SLOTS * j + k] = product
        ridge += RIDGE * s[STIFFNESS + SLOTS * j + j] / count
    for j in range(count):
        thrust = min(max(start[j], low[j]), high[j])
        s[THRUSTS_AT + j] = thrust
        product = 0.0
        for axis in range(WRENCH_AXES):
            product += weights[axis] * columns[j][axis] * wrench[axis]
        # The ridge pulls towards the start, so undetermined thrusts do not drift
        s[TARGET + j] = product + ridge * thrust
        s[STIFFNESS + SLOTS * j + j] += ridge
        s[FREE_AT + j] = 1.0 if low[j] < thrust < high[j] else 0.0


def _write_gradient(count: int, s: Scratch) -> None:
    """Write the negative gradient."""
    for j in range(count):
        pull = s[TARGET + j]
        for i in range(count):
            pull -= s[STIFFNESS + SLOTS * j + i] * s[THRUSTS_AT + i]
        s[PULL + j] = pull


def _solve_step(count: int, s: Scratch) -> None:
    """Write the step to the minimum over the free thrusts by Gaussian elimination; else 0."""
    for j in range(count):
        s[RIGHT + j] = s[PULL + j]
        s[STEP_AT + j] = 0.0
        for i in range(count):
            s[ROWS_AT + SLOTS * j + i] = s[STIFFNESS + SLOTS * j + i]
    for j in range(count):
        pivot = s[ROWS_AT + SLOTS * j + j]
        for k in range(j + 1, count):
            if s[FREE_AT + j] > 0.0 and s[FREE_AT + k] > 0.0 and pivot > 0.0:
                factor = s[ROWS_AT + SLOTS * k + j] / pivot
                s[RIGHT + k] -= factor * s[RIGHT + j]
                for i in range(j, count):
                    s[ROWS_AT + SLOTS * k + i] -= factor * s[ROWS_AT + SLOTS * j + i]
    # Back substitution
    for j in range(count - 1, -1, -1):
        pivot = s[ROWS_AT + SLOTS * j + j]
        if s[FREE_AT + j] > 0.0 and pivot > 0.0:
            rest = s[RIGHT + j]
            for i in range(j + 1, count):
                rest -= s[ROWS_AT + SLOTS * j + i] * s[STEP_AT + i]
            s[STEP_AT + j] = rest / pivot


def _find_rotor_to_free(rotors: Rotors, s: Scratch) -> int:
    """Return the rotor with the largest pull away from its limit, or -1."""
    most, rotor = INWARD, -1
    for j in range(rotors.number):
        stiffness = s[STIFFNESS + SLOTS * j + j]
        if s[FREE_AT + j] > 0.0 or stiffness <= 0.0:
            continue
        # Divided by the stiffness, the pull is in newtons of thrust and comparable between rotors.
        inward = s[PULL + j] if s[THRUSTS_AT + j] <= rotors.low[j] else -s[PULL + j]
        if inward / stiffness > most:
            most, rotor = inward / stiffness, j
    return rotor


def _read_solution(rotors: Rotors, s: Scratch) -> tuple[PerRotor, Wrench]:
    """Return the thrusts (0 in unused slots) and B times them."""
    for axis in range(WRENCH_AXES):
        s[WRENCH_AT + axis] = 0.0
    for j in range(rotors.number):
        for axis in range(WRENCH_AXES):
            s[WRENCH_AT + axis] += rotors.allocation[j][axis] * s[THRUSTS_AT + j]
    for j in range(rotors.number, SLOTS):
        s[THRUSTS_AT + j] = 0.0
    t, g = THRUSTS_AT, WRENCH_AT
    # The compiler needs tuples of fixed length.
    return (s[t], s[t + 1], s[t + 2], s[t + 3], s[t + 4], s[t + 5], s[t + 6], s[t + 7]), (
        s[g], s[g + 1], s[g + 2], s[g + 3], s[g + 4], s[g + 5],
    )  # fmt: skip


def thrusts_to_duties(rotors: Rotors, thrusts: PerRotor, scratch: Scratch) -> PerRotor:
    """
    Return the duty of each slot for its thrust. [N] to [1].

    It solves T = a u^2 + b u for the duty u, odd in T. `scratch` is as in `allocate`.
    """
    d, s = DUTIES, scratch
    for slot in range(SLOTS):
        s[d + slot] = 0.0
    for slot in range(rotors.number):
        thrust, a, b = thrusts[slot], rotors.a[slot], rotors.b[slot]
        # The curve is that of forward thrust: convert a reverse thrust to it first
        size = thrust if thrust >= 0.0 else -thrust / rotors.reverse[slot]
        if size > 0.0:
            # Rationalised form: no cancellation at small thrusts, and a = 0 is allowed
            duty = 2.0 * size / (b + math.sqrt(b * b + 4.0 * a * size))
            s[d + slot] = math.copysign(duty, thrust)
    return s[d], s[d + 1], s[d + 2], s[d + 3], s[d + 4], s[d + 5], s[d + 6], s[d + 7]
