"""
Stability margins of a loop from its frequency response.

L(jw) is the response of the loop cut open at one place, with the sign that makes the closed loop
1 / (1 + L). Where |L| = 1 the phase is above -180 degrees by the phase margin; where the phase is
-180 degrees (modulo 360) the gain may change by 1 / |L| before the loop oscillates (Astrom and
Murray, Feedback Systems, 2008, section 9.3). Of several crossings the nearest counts. A loop with
integrators may have a phase of -180 degrees below its crossover as well: then less gain makes it
oscillate, which is its lower gain margin. The delay margin is the phase margin over its frequency.
"""

from dataclasses import dataclass
import math
from typing import final

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]
Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class StabilityMargins:
    """
    How far a loop is from oscillating; None where nothing does.

    Attributes
    ----------
    gain : float or None
        Factor by which the gain may rise. [1]
    gain_down : float or None
        Factor, below 1, down to which it may fall. [1]
    phase : float or None
        Phase that may be lost. [rad]
    delay : float or None
        Delay that may be added. [s]
    crossover : float or None
        Where |L| = 1, the highest. [rad/s]
    oscillation : float or None
        At which it oscillates when the gain rises by `gain`. [rad/s]
    peak : float
        Largest |1 / (1 + L)|: 1 over the least distance to -1. [1]

    """

    gain: float | None
    gain_down: float | None
    phase: float | None
    delay: float | None
    crossover: float | None
    oscillation: float | None
    peak: float


def compute_margins(frequency: Array, response: Complex) -> StabilityMargins:
    """
    Return the margins of a loop that is stable when closed.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Increasing, dense enough to follow the phase. [rad/s]
    response : ndarray of complex, shape (n,)
        L(jw).

    """
    up, down = _gain_margins(frequency, response)
    least, last = _phase_margin(frequency, response)
    return StabilityMargins(
        gain=up and up[0],
        gain_down=down,
        phase=least and least[0],
        delay=least and least[0] / least[1],
        crossover=last,
        oscillation=up and up[1],
        peak=float(1.0 / np.abs(1.0 + response).min()),
    )


def _gain_margins(
    frequency: Array, response: Complex
) -> tuple[tuple[float, float] | None, float | None]:
    """Return the least factor above 1 with its frequency, and the largest below 1."""
    size, phase, log_w = np.log(np.abs(response)), _unwrap_phase(response), np.log(frequency)
    up: tuple[float, float] | None = None
    down: float | None = None
    for place, share in _find_phase_crossings(phase):
        factor = math.exp(-_interpolate(size, place, share))
        if factor > 1.0 and (up is None or factor < up[0]):
            up = (factor, math.exp(_interpolate(log_w, place, share)))
        elif factor < 1.0 and (down is None or factor > down):
            down = factor
    return up, down


def _phase_margin(
    frequency: Array, response: Complex
) -> tuple[tuple[float, float] | None, float | None]:
    """Return the least phase margin with its frequency, and the highest crossover."""
    size, phase, log_w = np.log(np.abs(response)), _unwrap_phase(response), np.log(frequency)
    least: tuple[float, float] | None = None
    last: float | None = None
    for place, share in _find_gain_crossings(size):
        last = math.exp(_interpolate(log_w, place, share))
        above = (_interpolate(phase, place, share) + math.pi) % (2.0 * math.pi)
        left = min(above, 2.0 * math.pi - above)
        if least is None or left < least[0]:
            least = (left, last)
    return least, last


def _unwrap_phase(response: Complex) -> Array:
    return np.unwrap(np.angle(response))


def _find_phase_crossings(phase: Array) -> list[tuple[int, float]]:
    """Return where a phase passes -180 degrees modulo 360."""
    turns = (phase + math.pi) / (2.0 * math.pi)
    found = []
    for k in range(len(turns) - 1):
        a, b = turns[k], turns[k + 1]
        if math.floor(a) != math.floor(b):
            whole = max(math.floor(a), math.floor(b))
            found.append((k, float((whole - a) / (b - a))))
    return found


def _find_gain_crossings(size: Array) -> list[tuple[int, float]]:
    """Return where the logarithm of a size passes 0."""
    changes = np.flatnonzero((size[:-1] > 0.0) != (size[1:] > 0.0))
    return [(int(k), float(size[k] / (size[k] - size[k + 1]))) for k in changes]


def _interpolate(values: Array, place: int, share: float) -> float:
    return float(values[place] + share * (values[place + 1] - values[place]))


def to_decibels(factor: float) -> float:
    """Return a factor of amplitude in decibels."""
    return 20.0 * math.log10(factor)
