"""
Find the direction to a lamp and its position, and learn the photodiodes while the drone turns.

The direction is the fit of `lta_vlc.direction_fit`. From its residuals `GainTracker` learns gains
and response. Diode i reads M_i where the fit expects m_i for a gain of 1 and the exponent p of the
response:

    log(M_i / m_i) = x_i + h_i q + c + e_i,    m_i = S cos_i^p + P,    h_i = d log(m_i) / dp

x_i is the logarithm of its gain, q what the exponent differs from p, c an error of the strength S
that all diodes share, and e_i what reflections change, of the variance PATTERN_ERROR^2 +
(OBLIQUE_ERROR (1 - cos_i))^2. A Kalman filter estimates all x_i and q; c is new in each block.
cos_i is that of the angle between diode and lamp; diodes that face away read reflections alone,
which the model knows badly, and are left out. The fit takes the values learnt so far, so that a
turn separates the gain of a diode from the direction of the lamp. All gains together cannot be
told from the brightness of the lamp: the mean of x stays 0. A drone that flies straight to a lamp
learns only the diodes that face it.

Blocks from one direction share their reflections, so each direction counts once. A block whose
residuals are larger than the model expects, as beside a wall or behind the hull, is ignored.

`PATTERN_ERROR`, `OBLIQUE_ERROR` and `STRENGTH_ERROR` are assumed: what reflections change on a
diode that faces the lamp, and on one at a right angle to it, and the error of S. `lta light
bearing --turn` tests them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
import math
from typing import Any, Final, final, NamedTuple

from lta_config.compilation.compiler import compile_functions
from lta_vlc.bearing import Bearing, estimate_bearing
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction_fit import DirectionFit, fit_direction, WIDEST_RESPONSE
from lta_vlc.lamp import estimate_lamp_position, LampEstimate, LampPrior
from lta_vlc.reading_model import DiodeFitInputs, DirectionPrior, FIT_SCRATCH
import numpy as np
from numpy.typing import NDArray

# White noise whose quiet bins have the mean magnitude m moves an amplitude by this much of m: the
# quiet bins are Rayleigh distributed.
RAYLEIGH_SHARE: Final = math.sqrt(2.0 / math.pi)
LEAST_DEVIATION: Final = 1e-3  # smallest standard deviation of a prior [rad, 1/m]
PATTERN_ERROR, OBLIQUE_ERROR = 0.06, 0.3  # relative standard deviation of a reading by reflections
STRENGTH_ERROR: Final = 0.1  # relative standard deviation of the fitted strength
LEAST_FACING: Final = 0.3  # least cosine to the lamp of a diode that is learnt from
SMALLEST_SPREAD: Final = 0.01  # spread that remains, however long the turn
LEAST_TURN: Final = math.tau / 20  # smallest turn between two blocks that are learnt from [rad]


@final
@dataclass(frozen=True, slots=True)
class Direction:
    """Direction to the lamp in the body frame."""

    # Unit vector from the middle of the diodes
    x: float
    y: float
    z: float
    # Covariance of azimuth and elevation by noise, unequal gains, reflections and priors [rad2]
    azimuth_variance: float
    cross_variance: float
    elevation_variance: float
    # Reading of a nominal diode that faces the lamp, of its direct light alone [counts]
    strength: float
    strength_deviation: float
    pedestal: float  # reading by diffuse light, the same for all diodes [counts]

    @property
    def azimuth(self) -> float:
        """Counter-clockwise from forward. [rad]."""
        return math.atan2(self.y, self.x)

    @property
    def elevation(self) -> float:
        """Upwards from the plane of forward and left. [rad]."""
        return math.atan2(self.z, math.sqrt(self.x * self.x + self.y * self.y))

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Of azimuth and elevation, shape (2, 2). [rad2]."""
        cross = self.cross_variance
        return np.array([[self.azimuth_variance, cross], [cross, self.elevation_variance]])


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
        learnt = max(SMALLEST_SPREAD, math.sqrt(float(variances[:-1].mean())))
        return replace(
            self._diodes,
            gains=tuple((self._prior * np.exp(self._state[:-1])).tolist()),
            spread=min(self._diodes.spread, learnt),  # never more than the prior
            response=max(WIDEST_RESPONSE, self._diodes.response + float(self._state[-1])),
            response_deviation=math.sqrt(float(variances[-1])),
        )

    def update_gains(self, peaks: Peaks, direction: Direction) -> None:
        """Learn from one block and the direction that a fit with the present values found."""
        cosine = self._axes @ (direction.x, direction.y, direction.z)
        # A spoilt or dead diode says nothing
        read = (peaks.snr > 0.0) & (peaks.amplitude > 0.0) & (self._prior > 0.0)
        used = np.flatnonzero((cosine > LEAST_FACING) & read)
        cosine = cosine[used]
        direct = direction.strength * cosine**self.diodes.response
        expected = direct + direction.pedestal
        if not used.size or expected.min() <= 0.0:
            return
        model = np.zeros((used.size, self._state.size))
        model[np.arange(used.size), used] = 1.0
        model[:, -1] = direct * np.log(cosine) / expected
        noise = (
            np.diag(PATTERN_ERROR**2 + (OBLIQUE_ERROR * (1.0 - cosine)) ** 2) + STRENGTH_ERROR**2
        )
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
class DirectionFinder:
    """
    Find directions with one array of diodes; `learns` if it learns their gains and response.

    `diodes`: the array by the vehicle file.
    """

    def __init__(self, diodes: DiodeArray, *, learns: bool = False) -> None:
        self.diodes = diodes  # with the values learnt so far
        self._inputs = build_fit_inputs(diodes, np.array)
        self._fit = compile_functions(fit_direction)[0]
        self._scratch = np.zeros(FIT_SCRATCH)
        self._tracker = GainTracker(diodes) if learns else None
        self._azimuth = math.inf  # of the newest block that was learnt from

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first block waits for it."""
        # Arguments of the types used later, so that the right signature is compiled
        dark = np.zeros(len(self.diodes.gains))
        self._find(Peaks(dark, dark + 1.0, dark, dark), 1.0, LampPrior())

    def find(self, peaks: Peaks, threshold: float, prior: LampPrior) -> Direction | None:
        """
        Return the direction, or None if no diode detects the lamp or all read the same.

        One diode at least must reach the SNR `threshold`; the others also constrain the direction.
        Diodes with an SNR of 0 are spoilt and left out. `prior` is the prior on the lamp.
        """
        direction = self._find(peaks, threshold, prior)
        if direction and self._tracker and self._has_turned(direction.azimuth):
            self._azimuth = direction.azimuth
            self._tracker.update_gains(peaks, direction)
            self.diodes = self._tracker.diodes
            self._inputs = build_fit_inputs(self.diodes, np.array)
        return direction

    def _find(self, peaks: Peaks, threshold: float, prior: LampPrior) -> Direction | None:
        # One diode above the threshold suffices: dark diodes also constrain the direction
        if not (peaks.snr >= threshold).any():
            return None
        # An infinite error leaves a spoilt diode out of the fit
        errors = np.where(peaks.snr > 0.0, RAYLEIGH_SHARE * peaks.noise, math.inf)
        fit: DirectionFit = self._fit(
            self._inputs, build_direction_prior(prior), peaks.amplitude, errors, self._scratch
        )
        if not fit.found:
            return None
        return Direction(
            fit.x,
            fit.y,
            fit.z,
            fit.azimuth_variance,
            fit.covariance,
            fit.elevation_variance,
            fit.strength,
            math.sqrt(fit.strength_variance),
            fit.pedestal,
        )

    def _has_turned(self, azimuth: float) -> bool:
        """Return whether the lamp is seen from another side than when last learnt from."""
        if math.isinf(self._azimuth):
            return True
        return abs(math.remainder(azimuth - self._azimuth, math.tau)) >= LEAST_TURN


class LampDetection(NamedTuple):
    """The paper's vector, and the lamp in the body frame; None where nothing is detected."""

    towards: Bearing | None = None
    lamp: LampEstimate | None = None


@final
class LampFinder:
    """Find the lamp with an array of diodes; `learns` if it learns their gains and response."""

    def __init__(self, diodes: DiodeArray, *, learns: bool = False) -> None:
        self.diodes = diodes
        self._finder = DirectionFinder(diodes, learns=learns)

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first block."""
        self._finder.prepare()

    def find_lamp(self, peaks: Peaks, threshold: float, prior: LampPrior) -> LampDetection:
        """Return bearing and position of the wanted beacon; `threshold` is an SNR."""
        towards = estimate_bearing(peaks, self.diodes.ring, threshold)
        direction = self._finder.find(peaks, threshold, prior)
        return LampDetection(
            towards, None if direction is None else estimate_lamp_position(direction, prior)
        )


def build_fit_inputs(
    diodes: DiodeArray, numbers: Callable[[Sequence[float]], Any] = tuple
) -> DiodeFitInputs:
    """Return the diodes as the fit takes them."""
    nx, ny, nz = (numbers(column) for column in zip(*diodes.axes, strict=True))
    rx, ry, rz = (numbers(column) for column in zip(*diodes.places, strict=True))
    gains = numbers(diodes.gains)
    deviation = max(diodes.response_deviation, LEAST_DEVIATION)
    return DiodeFitInputs(nx, ny, nz, rx, ry, rz, gains, diodes.response, deviation, diodes.spread)


def build_direction_prior(prior: LampPrior) -> DirectionPrior:
    """Return the prior of the fit for a lamp at the drone's height, within its deviation."""
    # The fit is linear in the inverse distance, not in the distance
    near = 1.0 / prior.distance
    return DirectionPrior(
        elevation=0.0,
        elevation_deviation=max(
            math.atan2(prior.height_deviation, prior.distance), LEAST_DEVIATION
        ),
        nearness=near,
        # d(1/r) = dr / r^2
        nearness_deviation=max(prior.distance_deviation * near * near, LEAST_DEVIATION),
    )
