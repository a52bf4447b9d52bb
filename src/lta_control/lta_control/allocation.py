"""
From a wanted force and moment to rotor thrusts, and from thrusts to duties.

The thrusts t minimise sum_i w_i (B t - wrench)_i^2 with 0 <= t <= t_max (or -t_max where a rotor
reverses): when the rotors cannot do everything, the weights say what gives way first. Solved by
coordinate descent from the last solution, which for four rotors needs no library and compiles.
"""

import math
from typing import NamedTuple

SWEEPS = 25  # the slowest direction shrinks by 0.67 a sweep: 1e-4 from a cold start


class Rotors(NamedTuple):
    """
    The thrust side of a vehicle, as the allocation needs it.

    Attributes
    ----------
    allocation : tuple of tuple of float
        B: one column a rotor, wrench (fx, fy, fz, mx, my, mz) per newton of thrust. [N/N, m]
    low, high : tuple of float
        Thrust limits of each rotor. [N]
    a, b : float
        Thrust curve T = a u^2 + b u, u = duty (paper section on thrust). [N]

    """

    allocation: tuple[tuple[float, ...], ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    a: float
    b: float

    @property
    def lowest_heave(self) -> float:
        """Strongest push downwards by the rotors that point up. [N]."""
        lows = zip(self.allocation, self.low, strict=True)
        return sum(column[2] * low for column, low in lows if column[2] > 0.5)


# Altitude before heading before speed; roll only so that the two vertical rotors share the load.
# Moments are scaled by a 0.1 m arm so that all weights compare newtons.
WEIGHTS = (1.0, 0.0, 100.0, 10.0, 0.0, 1000.0)


def allocate(
    rotors: Rotors, wrench: tuple[float, ...], start: tuple[float, ...]
) -> tuple[tuple[float, ...], tuple[float, ...]]:
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
    count = len(columns)
    thrusts = list(start)
    hessian = [[_weighted(p, q) for q in columns] for p in columns]
    gradient = [_weighted(column, wrench) for column in columns]
    for _ in range(SWEEPS):
        for j in range(count):
            row = hessian[j]
            if row[j] <= 0.0:
                continue  # a rotor that none of the weighted axes feels stays as it is
            pull = gradient[j]
            for i in range(count):
                if i != j:
                    pull -= row[i] * thrusts[i]
            thrusts[j] = min(max(pull / row[j], rotors.low[j]), rotors.high[j])
    given = tuple(
        sum(columns[j][axis] * thrusts[j] for j in range(count)) for axis in range(len(wrench))
    )
    return tuple(thrusts), given


def _weighted(p: tuple[float, ...], q: tuple[float, ...]) -> float:
    total = 0.0
    for weight, left, right in zip(WEIGHTS, p, q, strict=True):
        total += weight * left * right
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
