"""
Ambient light, the same from all sides: a steady part and mains flicker.

Mains lamps flicker at twice the mains frequency and at its multiples.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_model.light.light_checks import require, require_efficacy, require_lux


@final
@dataclass(frozen=True, slots=True)
class Ambient:
    """Ambient light, the same from all sides."""

    efficacy: float  # luminous by radiant flux, of the steady part and the flicker alike [lm/W]
    steady: float = 0.0  # mean illuminance [lx]
    mains: float = 0.0  # amplitude of the mains flicker; with its harmonics at most `steady` [lx]
    # Frequency of that flicker, twice that of the mains [Hz], and its phase at time zero [cycles]
    mains_frequency: float = 100.0
    mains_phase: float = 0.0
    # Amplitudes at two, three, ... times that frequency relative to `mains`, in phase with it
    mains_harmonics: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Refuse negative or infinite light."""
        require_efficacy(self.efficacy)
        require_lux('The ambient light', self.steady)
        require(
            all(0.0 <= part <= 1.0 for part in self.mains_harmonics),
            f'The harmonics of the mains flicker are {self.mains_harmonics}; each must be '
            'from 0 to 1, relative to the fundamental.',
        )
        require(
            # The sum must not become negative at any time of the flicker
            0.0 <= self.mains <= self.steady / (1.0 + sum(self.mains_harmonics)),
            f'The mains flicker has an amplitude of {self.mains} lx around a mean of '
            f'{self.steady} lx; the amplitude, including harmonics, must be from 0 to the '
            'mean.',
        )
        require(
            math.isfinite(self.mains_frequency) and self.mains_frequency > 0.0,
            f'The mains flicker has a frequency of {self.mains_frequency} Hz; the frequency '
            'must be positive.',
        )
        require(
            math.isfinite(self.mains_phase),
            f'The mains flicker has a phase of {self.mains_phase} cycles; the phase must be '
            'finite.',
        )
