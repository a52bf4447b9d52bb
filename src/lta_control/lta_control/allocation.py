"""
From a wanted force and moment to rotor thrusts, and from thrusts to duties.

The thrusts t minimise sum_i w_i (B t - wrench)_i^2 with 0 <= t <= t_max (or -t_max where a rotor
reverses): when the rotors cannot do everything, the weights say what gives way first. Solved
exactly by an active set (Nocedal and Wright 2006, Numerical Optimization, section 16.5) from the
last solution: rotors at a limit are held there while the others take the best step. For four
rotors this needs no library and compiles.
"""

import math
from typing import NamedTuple

AXES = 6

ROUNDS = 60  # at most; four rotors from anywhere need fewer than a dozen
RIDGE = 1e-9  # of the mean stiffness: what no weighted axis feels stays as it is
INWARD = 1e-12  # pull away from a limit that counts as one [N]

Thrusts = tuple[float, float, float, float]
Wrench = tuple[float, float, float, float, float, float]


class Rotors(NamedTuple):
    """
    The thrust side of a vehicle, as the allocation needs it.

    Attributes
    ----------
    allocation : tuple of tuple of float
        B: one column a rotor, wrench (fx, fy, fz, mx, my, mz) per newton of thrust. [N/N, m]
    low, high : tuple of float
        Thrust limits of each rotor. [N]
    lowest_heave : float
        Strongest push downwards by the rotors that point up. [N]
    a, b : float
        Thrust curve T = a u^2 + b u, u = duty (paper section on thrust). [N]

    """

    allocation: tuple[tuple[float, ...], ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    lowest_heave: float
    a: float
    b: float


# Altitude before heading before speed; roll only so that the two vertical rotors share the load.
# Moments are scaled by a 0.1 m arm so that all weights compare newtons.
WEIGHTS = (1.0, 0.0, 100.0, 10.0, 0.0, 1000.0)


def allocate(rotors: Rotors, wrench: Wrench, start: Thrusts) -> tuple[Thrusts, Wrench]:
    """
    Return rotor thrusts and the wrench they give.

    Parameters
    ----------
    rotors : Rotors
        B and thrust limits.
    wrench : tuple
        Wanted force and moment about the hull centre, body frame. [N, N m]
    start : tuple
        Thrusts of the last step, where the search begins. [N]

    """
    columns = rotors.allocation
    low, high = rotors.low, rotors.high
    count = len(columns)
    stiffness = [[_weighted(p, q) for q in columns] for p in columns]
    ridge = 0.0
    for j in range(count):
        ridge += RIDGE * stiffness[j][j] / count
    thrusts = [min(max(start[j], low[j]), high[j]) for j in range(count)]
    target = [_weighted(columns[j], wrench) + ridge * thrusts[j] for j in range(count)]
    for j in range(count):
        stiffness[j][j] += ridge
    free = [low[j] < thrusts[j] < high[j] for j in range(count)]
    for _ in range(ROUNDS):
        step = _solved(stiffness, _pull(stiffness, target, thrusts), free)
        share, stop = _reach(rotors, thrusts, step)
        for j in range(count):
            thrusts[j] = min(max(thrusts[j] + share * step[j], low[j]), high[j])
        if stop >= 0:
            thrusts[stop] = high[stop] if step[stop] > 0.0 else low[stop]
            free[stop] = False
            continue
        stop = _held_back(rotors, stiffness, _pull(stiffness, target, thrusts), thrusts, free)
        if stop < 0:
            break
        free[stop] = True
    given = [0.0] * AXES
    for j in range(count):
        for axis in range(AXES):
            given[axis] += columns[j][axis] * thrusts[j]
    # Tuples of fixed length, so that this compiles.
    return (thrusts[0], thrusts[1], thrusts[2], thrusts[3]), (
        given[0], given[1], given[2], given[3], given[4], given[5],
    )  # fmt: skip


def _pull(stiffness: list[list[float]], target: list[float], thrusts: list[float]) -> list[float]:
    """Return minus the gradient: where each thrust would go."""
    pull = list(target)
    for j in range(len(target)):
        for i in range(len(target)):
            pull[j] -= stiffness[j][i] * thrusts[i]
    return pull


def _solved(stiffness: list[list[float]], pull: list[float], free: list[bool]) -> list[float]:
    """Return the step to the minimum over the free thrusts; 0 for the others (elimination)."""
    count = len(pull)
    rows = [list(row) for row in stiffness]
    right = list(pull)
    step = [0.0] * count
    for j in range(count):
        for k in range(j + 1, count):
            if free[j] and free[k] and rows[j][j] > 0.0:
                factor = rows[k][j] / rows[j][j]
                right[k] -= factor * right[j]
                for i in range(j, count):
                    rows[k][i] -= factor * rows[j][i]
    for j in range(count - 1, -1, -1):
        if free[j] and rows[j][j] > 0.0:
            rest = right[j]
            for i in range(j + 1, count):
                rest -= rows[j][i] * step[i]
            step[j] = rest / rows[j][j]
    return step


def _reach(rotors: Rotors, thrusts: list[float], step: list[float]) -> tuple[float, int]:
    """Return the share of a step that no limit forbids, and the rotor at whose it ends or -1."""
    share, stop = 1.0, -1
    for j in range(len(step)):
        limit = rotors.high[j] if step[j] > 0.0 else rotors.low[j]
        if share * abs(step[j]) > abs(limit - thrusts[j]):
            share, stop = abs(limit - thrusts[j]) / abs(step[j]), j
    return share, stop


def _held_back(
    rotors: Rotors,
    stiffness: list[list[float]],
    pull: list[float],
    thrusts: list[float],
    free: list[bool],
) -> int:
    """Return the rotor that most wants to leave its limit, or -1."""
    most, found = INWARD, -1
    for j in range(len(pull)):
        if free[j] or stiffness[j][j] <= 0.0:
            continue
        inward = pull[j] if thrusts[j] <= rotors.low[j] else -pull[j]
        if inward / stiffness[j][j] > most:
            most, found = inward / stiffness[j][j], j
    return found


def _weighted(p: tuple[float, ...], q: tuple[float, ...]) -> float:
    total = 0.0
    for axis in range(AXES):
        total += WEIGHTS[axis] * p[axis] * q[axis]
    return total


def duty(thrust: float, a: float, b: float) -> float:
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
