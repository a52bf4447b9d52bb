"""
Compute the stability margins of a loop from its frequency response.

L(jw) is the open-loop response, with the sign that makes the closed loop 1 / (1 + L). The phase
margin is the phase above -180 degrees where |L| = 1. The gain margin is 1 / |L| where the phase is
-180 degrees modulo 360 (Astrom and Murray, Feedback Systems, 2008, section 9.3). Of several
crossings the closest to instability counts. A loop with integrators may also cross -180 degrees
below its crossover: it then oscillates with less gain, which gives a lower gain margin. The delay
margin is the phase margin over its frequency.
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
    """Stability margins of a loop; None where a margin is unlimited."""

    gain: float | None  # factor by which the gain may rise [1]
    gain_down: float | None  # factor below 1 to which the gain may fall [1]
    phase: float | None  # phase margin [rad]
    delay: float | None  # delay margin [s]
    crossover: float | None  # highest frequency with |L| = 1 [rad/s]
    oscillation: float | None  # frequency of oscillation at the gain limit [rad/s]
    peak: float  # peak sensitivity, the maximum of |1 / (1 + L)| [1]


def compute_margins(frequency: Array, response: Complex) -> StabilityMargins:
    """
    Compute the margins of a loop that is stable when closed.

    `frequency`, shape (n,): increasing, dense enough to unwrap the phase [rad/s]. `response`,
    shape (n,): L(jw).
    """
    up, down = _gain_margins(frequency, response)
    least, last = _phase_margin(frequency, response)
    return StabilityMargins(
        # `and` passes None on for a margin that does not exist.
        gain=up and up[0],
        gain_down=down,
        phase=least and least[0],
        delay=least and least[0] / least[1],
        crossover=last,
        oscillation=up and up[1],
        # Peak of the sensitivity: inverse of the smallest distance to the point -1
        peak=float(1.0 / np.abs(1.0 + response).min()),
    )


def _gain_margins(
    frequency: Array, response: Complex
) -> tuple[tuple[float, float] | None, float | None]:
    """Return the upper gain margin with its frequency, and the lower gain margin."""
    size, phase, log_w = np.log(np.abs(response)), _unwrap_phase(response), np.log(frequency)
    up: tuple[float, float] | None = None
    down: float | None = None
    for place, share in _find_phase_crossings(phase):
        # Logarithms interpolate |L| well, as it follows powers of the frequency.
        factor = math.exp(-_interpolate(size, place, share))
        # Above 1: the gain may rise by it. Below 1: it may fall to it. Keep the closest to 1.
        if factor > 1.0 and (up is None or factor < up[0]):
            up = (factor, math.exp(_interpolate(log_w, place, share)))
        elif factor < 1.0 and (down is None or factor > down):
            down = factor
    return up, down


def _phase_margin(
    frequency: Array, response: Complex
) -> tuple[tuple[float, float] | None, float | None]:
    """Return the smallest phase margin with its frequency, and the highest crossover."""
    size, phase, log_w = np.log(np.abs(response)), _unwrap_phase(response), np.log(frequency)
    least: tuple[float, float] | None = None
    last: float | None = None
    for place, share in _find_gain_crossings(size):
        last = math.exp(_interpolate(log_w, place, share))
        above = (_interpolate(phase, place, share) + math.pi) % (2.0 * math.pi)
        # Instability can also be reached from the other side, by phase lead.
        left = min(above, 2.0 * math.pi - above)
        if least is None or left < least[0]:
            least = (left, last)
    return least, last


def _unwrap_phase(response: Complex) -> Array:
    return np.unwrap(np.angle(response))


def _find_phase_crossings(phase: Array) -> list[tuple[int, float]]:
    """Return the index and fraction of each crossing of -180 degrees modulo 360."""
    # Whole numbers where the phase is -180 degrees modulo 360
    turns = (phase + math.pi) / (2.0 * math.pi)
    crossings = []
    for k in range(len(turns) - 1):
        a, b = turns[k], turns[k + 1]
        if math.floor(a) != math.floor(b):
            # The whole number between a and b
            whole = max(math.floor(a), math.floor(b))
            crossings.append((k, float((whole - a) / (b - a))))
    return crossings


def _find_gain_crossings(size: Array) -> list[tuple[int, float]]:
    """Return the index and fraction of each zero crossing of log |L|."""
    # |L| crosses 1 where log |L| changes its sign.
    changes = np.flatnonzero((size[:-1] > 0.0) != (size[1:] > 0.0))
    return [(int(k), float(size[k] / (size[k] - size[k + 1]))) for k in changes]


def _interpolate(values: Array, place: int, share: float) -> float:
    return float(values[place] + share * (values[place + 1] - values[place]))


def to_decibels(factor: float) -> float:
    """Convert an amplitude factor to decibels."""
    return 20.0 * math.log10(factor)
