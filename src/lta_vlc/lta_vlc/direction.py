"""Estimate the direction to a lamp: interface to the fit of `lta_vlc.direction_fit`."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import Any, final

from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction_fit import DirectionFit, fit_direction
from lta_vlc.lamp import LampPrior
from lta_vlc.reading_model import DirectionPrior, FIT_SCRATCH, FitArray
import numpy as np
from numpy.typing import NDArray

# White noise whose quiet bins have the mean magnitude m moves an amplitude by this much of m: the
# quiet bins are Rayleigh distributed.
PART = math.sqrt(2.0 / math.pi)
LEAST = 1e-3  # standard deviation of what a prior holds for certain [rad, 1/m]


@final
@dataclass(frozen=True, slots=True)
class Direction:
    """
    Where the lamp is seen, in the body frame.

    Parameters
    ----------
    x, y, z : float
        Unit vector from the middle of the diodes.
    azimuth_variance, cross_variance, elevation_variance : float
        Covariance of azimuth and elevation: noise, unequal gains, reflections, and the prior where
        the diodes do not tell. [rad2]
    strength, strength_deviation : float
        Reading of a nominal diode that faces the lamp, of its direct light alone. [counts]
    pedestal : float
        Reading by diffuse light, the same of all diodes. [counts]

    """

    x: float
    y: float
    z: float
    azimuth_variance: float
    cross_variance: float
    elevation_variance: float
    strength: float
    strength_deviation: float
    pedestal: float

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
class DirectionFinder:
    """
    Find directions with one array of diodes.

    Parameters
    ----------
    diodes : Diodes
        As the drone believes them.
    core : callable
        `lta_vlc.direction_fit.fit_direction`, or it compiled; the results are the same to the last
        bit.
    numbers : callable
        What the core reads fastest: tuples plain, arrays compiled.

    """

    def __init__(
        self,
        diodes: DiodeArray,
        core: Callable[..., Any] = fit_direction,
        numbers: Callable[[Sequence[float]], Any] = tuple,
    ) -> None:
        self._array = build_fit_array(diodes, numbers)
        self._core = core
        self._numbers = numbers
        self._scratch = np.zeros(FIT_SCRATCH) if core is not fit_direction else [0.0] * FIT_SCRATCH

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first block waits for it."""
        dark = np.zeros(len(self._array.gains))
        self.find(Peaks(dark, dark + 1.0, dark, dark), 1.0, LampPrior())

    def find(self, peaks: Peaks, threshold: float, prior: LampPrior) -> Direction | None:
        """
        Return the direction, or None where no diode hears the lamp or all read the same.

        Parameters
        ----------
        peaks : Peaks
            What each diode sees, in the order of the diodes.
        threshold : float
            SNR that one diode at least must reach. The others count as well: that they see
            nothing tells where the lamp is not. Those without any SNR are spoilt and left out.
        prior : LampPrior
            The lamp before it is seen.

        """
        if not (peaks.snr >= threshold).any():
            return None
        errors = np.where(peaks.snr > 0.0, PART * peaks.noise, math.inf)
        readings = peaks.amplitude
        if self._numbers is tuple:
            readings, errors = readings.tolist(), errors.tolist()
        found: DirectionFit = self._core(
            self._array, build_direction_prior(prior), readings, errors, self._scratch
        )
        if not found.found:
            return None
        return Direction(
            found.x, found.y, found.z,
            found.azimuth_variance, found.covariance, found.elevation_variance,
            found.strength, math.sqrt(found.strength_variance), found.pedestal,
        )  # fmt: skip


def build_fit_array(
    diodes: DiodeArray, numbers: Callable[[Sequence[float]], Any] = tuple
) -> FitArray:
    """Return the diodes as the fit takes them."""
    nx, ny, nz = (numbers(column) for column in zip(*diodes.axes, strict=True))
    rx, ry, rz = (numbers(column) for column in zip(*diodes.places, strict=True))
    gains = numbers(diodes.gains)
    return FitArray(nx, ny, nz, rx, ry, rz, gains, diodes.response, diodes.spread)


def build_direction_prior(prior: LampPrior) -> DirectionPrior:
    """Return what the fit expects of a lamp that is level with the drone but for its height."""
    near = 1.0 / prior.distance
    return DirectionPrior(
        elevation=0.0,
        elevation_deviation=max(math.atan2(prior.height_deviation, prior.distance), LEAST),
        nearness=near,
        nearness_deviation=max(prior.distance_deviation * near * near, LEAST),
    )
