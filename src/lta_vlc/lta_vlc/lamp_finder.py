"""From the peaks of one beacon to the paper's vector and to where its lamp is."""

from typing import final, NamedTuple

from lta_config.compilation.compiled import compiled
from lta_vlc.array import Bearing, bearing
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import Diodes
from lta_vlc.direction import DirectionFinder
from lta_vlc.fit import fit
from lta_vlc.lamp import lamp_estimate, LampEstimate, LampPrior
import numpy as np


class Found(NamedTuple):
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

    def __init__(self, diodes: Diodes) -> None:
        self.diodes = diodes
        self._finder = DirectionFinder(diodes, compiled(fit)[0], np.array)

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first peaks wait for it."""
        self._finder.prepare()

    def found(self, peaks: Peaks, threshold: float, prior: LampPrior) -> Found:
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
        towards = bearing(peaks, self.diodes.ring, threshold)
        direction = self._finder.find(peaks, threshold, prior)
        return Found(towards, None if direction is None else lamp_estimate(direction, prior))
