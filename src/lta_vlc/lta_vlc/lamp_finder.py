"""Estimate bearing and lamp position from the peaks of one beacon."""

from typing import final, NamedTuple

from lta_config.compilation.compiler import compile_functions
from lta_vlc.bearing import Bearing, estimate_bearing
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction import DirectionFinder
from lta_vlc.direction_fit import fit_direction
from lta_vlc.lamp import estimate_lamp_position, LampEstimate, LampPrior
import numpy as np


class LampDetection(NamedTuple):
    """The paper's vector, and the lamp in the body frame; None where nothing is believed."""

    towards: Bearing | None = None
    lamp: LampEstimate | None = None


@final
class LampFinder:
    """
    Find the lamp by an array of diodes.

    Parameters
    ----------
    diodes : Diodes
        The array.

    """

    def __init__(self, diodes: DiodeArray) -> None:
        self.diodes = diodes
        self._finder = DirectionFinder(diodes, compile_functions(fit_direction)[0], np.array)

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first peaks wait for it."""
        self._finder.prepare()

    def find(self, peaks: Peaks, threshold: float, prior: LampPrior) -> LampDetection:
        """
        Return what the peaks of the wanted beacon say.

        Parameters
        ----------
        peaks : Peaks
            One a diode.
        threshold : float
            SNR from which a diode is believed. [1]
        prior : LampPrior
            The lamp before it is seen.

        """
        towards = estimate_bearing(peaks, self.diodes.ring, threshold)
        direction = self._finder.find(peaks, threshold, prior)
        return LampDetection(
            towards, None if direction is None else estimate_lamp_position(direction, prior)
        )
