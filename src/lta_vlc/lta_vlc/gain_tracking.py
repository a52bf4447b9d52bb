"""
Learn the gains of photodiodes while the drone turns, from what the fits of a direction leave over.

Diode i reads M_i where the fit expects m_i for a gain of 1. With the logarithm x_i of its gain,

    x_i <- x_i + K_i (log(M_i / m_i) - x_i),    v_i <- (1 - K_i) v_i,    K_i = v_i / (v_i + R_i)
    m_i = S cos_i^p + P,    R_i = PATTERN^2 + (OBLIQUE (1 - cos_i))^2

a Kalman filter for each diode. cos_i is that of the angle between diode and lamp; diodes that face
away read reflections alone, which the model knows badly, and are left out. The fit takes the gains
learnt so far, so that a turn separates the gain of a diode from the direction of the lamp. All
gains together cannot be told from the brightness of the lamp: the mean of x stays 0. A drone that
flies straight to a lamp learns only the diodes that face it.

`PATTERN` and `OBLIQUE` are assumed: what reflections change on a diode that faces the lamp, and on
one at a right angle to it. `lta light bearing --turn` tests them.
"""

from dataclasses import replace
import math
from typing import Final, final

from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction import Direction
import numpy as np

PATTERN, OBLIQUE = 0.06, 0.3  # relative standard deviation of a reading by reflections
FACING: Final = 0.3  # least cosine to the lamp of a diode that is learnt from
SMALLEST: Final = 0.01  # spread that remains, however long the turn


@final
class GainTracker:
    """
    The gains of an array, as learnt so far.

    `diodes`: the array by the vehicle file: gains and their spread are the prior.
    """

    def __init__(self, diodes: DiodeArray) -> None:
        self._diodes = diodes
        self._axes = np.array(diodes.axes)
        self._prior = np.array(diodes.gains)
        self._log = np.zeros(len(self._prior))
        self._variance = np.full(len(self._prior), diodes.spread**2)

    @property
    def diodes(self) -> DiodeArray:
        """The array with the gains learnt so far, and the spread that remains."""
        learnt = max(SMALLEST, math.sqrt(float(self._variance.mean())))
        spread = min(self._diodes.spread, learnt)  # never more than the prior
        gains = tuple((self._prior * np.exp(self._log)).tolist())
        return replace(self._diodes, gains=gains, spread=spread)

    def update_gains(self, peaks: Peaks, direction: Direction) -> None:
        """Learn from one block and the direction that a fit with the present gains found."""
        cosine = np.maximum(self._axes @ (direction.x, direction.y, direction.z), 0.0)
        expected = direction.strength * cosine**self._diodes.response + direction.pedestal
        # A spoilt or dead diode says nothing
        used = (cosine > FACING) & (peaks.snr > 0.0) & (self._prior > 0.0) & (expected > 0.0)
        read = np.where(used, peaks.amplitude / np.where(used, self._prior * expected, 1.0), 1.0)
        noise = PATTERN**2 + (OBLIQUE * (1.0 - cosine)) ** 2
        gain = np.where(used, self._variance / (self._variance + noise), 0.0)
        self._log += gain * (np.log(np.maximum(read, 1e-6)) - self._log)
        self._variance *= 1.0 - gain
        self._log -= self._log.mean()
