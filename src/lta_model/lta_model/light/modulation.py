"""
The lamp's square wave, exact at any time.

A lamp is on for the first `duty` of each period and off for the rest: its wave is 1 or 0. Time is
in integer nanoseconds; the phase of the first of a set of times is computed in whole numbers, so
it neither drifts nor loses digits, however long the clock has run.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_config.errors import BadInput
import numpy as np
from numpy.typing import NDArray

NANOSECONDS = 1_000_000_000


def phase_in_cycles(
    times: NDArray[np.int64], frequency: float, phase: float = 0.0
) -> NDArray[np.float64]:
    """
    Return the position within the period, in [0, 1), at int64 times [ns], at least one. [cycles]

    `phase` is the position at time zero. Only differences to the first time are multiplied in
    floating point: over a span of one second the error is some 1e-14 of the cycles in it.
    """
    top, bottom = frequency.as_integer_ratio()
    bottom *= NANOSECONDS
    # Exact integer arithmetic, whatever the age of the clock
    start = (int(times[0]) * top % bottom) / bottom + phase
    position: NDArray[np.float64] = (start + (times - times[0]) * (frequency / NANOSECONDS)) % 1.0
    # A tiny negative position is rounded up to one whole cycle by the modulo.
    position[position == 1.0] = 0.0
    return position


@final
@dataclass(frozen=True, slots=True)
class SquareWave:
    """A wave that is 1 for the first part of each period and 0 for the rest."""

    frequency: float  # positive [Hz]
    duty: float = 0.5  # share of the period that it is on, between 0 and 1, both excluded
    phase: float = 0.0  # position in the period at time zero [cycles]

    def __post_init__(self) -> None:
        """Refuse an invalid wave."""
        if not (math.isfinite(self.frequency) and self.frequency > 0.0):
            raise BadInput(
                f'The lamp flickers at {self.frequency} Hz; the frequency must be positive.'
            )
        if not 0.0 < self.duty < 1.0:
            raise BadInput(
                f'The lamp has a duty cycle of {self.duty}; the duty cycle must be between '
                '0 and 1.'
            )
        if not math.isfinite(self.phase):
            raise BadInput(
                f'The lamp has a phase of {self.phase} cycles; the phase must be finite.'
            )

    def phase_in_cycles(self, times: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the position in the period, in [0, 1), at times in ns, shape (n,)."""
        return phase_in_cycles(times, self.frequency, self.phase)

    def sample_wave(self, times: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the wave, 0 or 1, at times in ns, shape (n,)."""
        return (self.phase_in_cycles(times) < self.duty).astype(np.float64)

    def sample_filtered(
        self, times: NDArray[np.int64], time_constant: float
    ) -> NDArray[np.float64]:
        r"""
        Return the wave as a first-order low pass passes it on, long after its start.

        Parameters
        ----------
        times : ndarray of int64, shape (n,)
            Times. [ns]
        time_constant : float
            Time constant of the low pass, positive. [s]

        Returns
        -------
        ndarray of float64, shape (n,)
            Output of the low pass, in [0, 1].

        Notes
        -----
        Exact at any time constant, with edges between the samples. With periods :math:`x`, duty
        :math:`d` and :math:`k = 1/(f\tau)` the periodic solution of :math:`\tau y' = s - y` is

        .. math::
            y = 1 - \frac{1 - e^{-k(1-d)}}{1 - e^{-k}} e^{-kx} \ (x < d), \qquad
            y = \frac{1 - e^{-kd}}{1 - e^{-k}} e^{-k(x-d)} \ (x \ge d)

        """
        position = self.phase_in_cycles(times)
        rate = 1.0 / (self.frequency * time_constant)
        # expm1 keeps the digits for long time constants
        whole = -math.expm1(-rate)
        # Distance from 1 at the rising edge, and from 0 at the falling edge, in the periodic state
        missing = -math.expm1(-rate * (1.0 - self.duty)) / whole
        left = -math.expm1(-rate * self.duty) / whole
        on = position < self.duty
        # Since the last edge
        decay = np.exp(-rate * np.where(on, position, position - self.duty))
        return np.where(on, 1.0 - missing * decay, left * decay)
