"""
Learn gains and response of photodiodes while the drone turns, from the residuals of the fits.

Diode i reads M_i where the fit expects m_i for a gain of 1 and the exponent p of the response:

    log(M_i / m_i) = x_i + h_i q + c + e_i,    m_i = S cos_i^p + P,    h_i = d log(m_i) / dp

x_i is the logarithm of its gain, q what the exponent differs from p, c an error of the strength S
that all diodes share, and e_i what reflections change: R_i = PATTERN^2 + (OBLIQUE (1 - cos_i))^2.
A Kalman filter estimates all x_i and q; c is new in each block. cos_i is that of the angle between
diode and lamp; diodes that face away read reflections alone, which the model knows badly, and are
left out. The fit takes the values learnt so far, so that a turn separates the gain of a diode from
the direction of the lamp. All gains together cannot be told from the brightness of the lamp: the
mean of x stays 0. A drone that flies straight to a lamp learns only the diodes that face it.

Blocks from one direction share their reflections, so each direction counts once. A block whose
residuals are larger than the model expects, as beside a wall or behind the hull, is ignored.

`PATTERN`, `OBLIQUE` and `LEVEL` are assumed: what reflections change on a diode that faces the
lamp, and on one at a right angle to it, and the error of S. `lta light bearing --turn` tests them.
"""

from dataclasses import replace
import math
from typing import Final, final

from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction import compile_direction_finder, Direction, DirectionFinder
from lta_vlc.direction_fit import WIDEST
from lta_vlc.lamp import LampPrior
import numpy as np

PATTERN, OBLIQUE = 0.06, 0.3  # relative standard deviation of a reading by reflections
LEVEL: Final = 0.1  # relative standard deviation of the fitted strength
FACING: Final = 0.3  # least cosine to the lamp of a diode that is learnt from
SMALLEST: Final = 0.01  # spread that remains, however long the turn
SECTOR: Final = math.tau / 20  # smallest turn between two blocks that are learnt from [rad]


@final
class GainTracker:
    """
    Gains and response of an array, as learnt so far.

    `diodes`: the array by the vehicle file, whose gains, exponent and deviations are the prior.
    """

    def __init__(self, diodes: DiodeArray) -> None:
        self._diodes = diodes
        self._axes = np.array(diodes.axes)
        self._prior = np.array(diodes.gains)
        count = len(self._prior)
        # Logarithm of each gain, and the exponent less that of the file
        self._state = np.zeros(count + 1)
        deviations = [diodes.spread] * count + [diodes.response_deviation]
        self._covariance = np.diag(np.square(deviations))

    @property
    def diodes(self) -> DiodeArray:
        """The array with the values learnt so far, and the deviations that remain."""
        variances = self._covariance.diagonal()
        learnt = max(SMALLEST, math.sqrt(float(variances[:-1].mean())))
        return replace(
            self._diodes,
            gains=tuple((self._prior * np.exp(self._state[:-1])).tolist()),
            spread=min(self._diodes.spread, learnt),  # never more than the prior
            response=max(WIDEST, self._diodes.response + float(self._state[-1])),
            response_deviation=math.sqrt(float(variances[-1])),
        )

    def update_gains(self, peaks: Peaks, direction: Direction) -> None:
        """Learn from one block and the direction that a fit with the present values found."""
        cosine = self._axes @ (direction.x, direction.y, direction.z)
        # A spoilt or dead diode says nothing
        read = (peaks.snr > 0.0) & (peaks.amplitude > 0.0) & (self._prior > 0.0)
        used = np.flatnonzero((cosine > FACING) & read)
        cosine = cosine[used]
        direct = direction.strength * cosine**self.diodes.response
        expected = direct + direction.pedestal
        if not used.size or expected.min() <= 0.0:
            return
        model = np.zeros((used.size, self._state.size))
        model[np.arange(used.size), used] = 1.0
        model[:, -1] = direct * np.log(cosine) / expected
        noise = np.diag(PATTERN**2 + (OBLIQUE * (1.0 - cosine)) ** 2) + LEVEL**2
        odd = np.log(peaks.amplitude[used] / (self._prior[used] * expected)) - self._state[used]
        shared = self._covariance @ model.T
        innovation = model @ shared + noise
        # More than its expected value: the lamp is hidden, or reflections are unusually strong
        if odd @ np.linalg.solve(innovation, odd) > used.size:
            return
        gain = np.linalg.solve(innovation, shared.T).T
        self._state += gain @ odd
        self._covariance -= gain @ shared.T
        self._state[:-1] -= self._state[:-1].mean()


@final
class LearningDirectionFinder:
    """
    Find directions with the gains and the response that the flight has taught so far.

    `diodes`: the array by the vehicle file. The same interface as `DirectionFinder`.
    """

    def __init__(self, diodes: DiodeArray) -> None:
        self._tracker = GainTracker(diodes)
        self._finder = compile_direction_finder(diodes)
        self._azimuth: float | None = None  # of the newest block that was used

    @property
    def diodes(self) -> DiodeArray:
        """The array with the values learnt so far."""
        return self._tracker.diodes

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first block waits for it."""
        self._finder.prepare()

    def find(self, peaks: Peaks, threshold: float, prior: LampPrior) -> Direction | None:
        """Return the direction as `DirectionFinder.find` does, and learn from the block."""
        direction = self._finder.find(peaks, threshold, prior)
        if direction is not None and self._has_turned(direction.azimuth):
            self._azimuth = direction.azimuth
            self._tracker.update_gains(peaks, direction)
            self._finder = compile_direction_finder(self._tracker.diodes)
        return direction

    def _has_turned(self, azimuth: float) -> bool:
        """Return whether the lamp is seen from another side than when last learnt from."""
        if self._azimuth is None:
            return True
        return abs(math.remainder(azimuth - self._azimuth, math.tau)) >= SECTOR


def build_direction_finder(
    diodes: DiodeArray, *, learns: bool
) -> DirectionFinder | LearningDirectionFinder:
    """Return a finder with the compiled fit; `learns` if it learns gains and response."""
    return LearningDirectionFinder(diodes) if learns else compile_direction_finder(diodes)
