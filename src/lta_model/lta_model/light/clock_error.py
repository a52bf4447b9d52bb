"""
Clock error with a constant offset and a drift.

With the nominal frequency f, offset o and drift d the wave's phase after t is f ((1 + o) t + d t^2
/ 2). Around a time t0 that is a wave of the frequency f (1 + o + d t0) whose phase at time zero is
less by f d t0^2 / 2; the rest of d t^2, some 1e-8 of a cycle in 0.1 s at 1 ppm/s, is neglected.
"""

from dataclasses import dataclass, replace
import math
from typing import final

from lta_model.light.light_checks import require
from lta_model.light.modulation import NANOSECONDS, SquareWave

MOST_OFFSET = 0.01  # an error above one percent means a broken clock


@final
@dataclass(frozen=True, slots=True)
class DriftingClock:
    """Offset and drift of a clock."""

    offset: float = 0.0
    drift: float = 0.0

    def __post_init__(self) -> None:
        """Refuse an impossible clock error."""
        require(
            abs(self.offset) <= MOST_OFFSET,
            f'The clock of the lamp is off by {1e6 * self.offset:g} ppm; the offset must '
            f'be at most {1e6 * MOST_OFFSET:g} ppm.',
        )
        require(
            math.isfinite(self.drift),
            f"The drift of the lamp's clock is {self.drift}/s; it must be a finite number.",
        )

    def distort_wave(self, wave: SquareWave, time: int) -> SquareWave:
        """Return a wave as timed by this clock around a time. [ns]"""
        if self.offset == 0.0 and self.drift == 0.0:
            return wave
        seconds = time / NANOSECONDS
        return replace(
            wave,
            # Instantaneous frequency at that time
            frequency=wave.frequency * (1.0 + self.offset + self.drift * seconds),
            # Keeps the phase continuous at that time
            phase=wave.phase - 0.5 * wave.frequency * self.drift * seconds * seconds,
        )


RIGHT = DriftingClock()
