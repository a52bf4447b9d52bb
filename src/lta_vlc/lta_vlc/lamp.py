# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the lamp by what the photodiodes read: the paper's bearing, a fitted direction, a position.

The paper's bearing is a weighted mean over a ring. Body frame FLU: azimuth 0 is forward and grows
counter-clockwise. With diode axes n_i = (cos phi_i, sin phi_i) and peak amplitudes M_i,

    v = sum(M'_i n_i) / sum(M'_i),  theta = atan2(v_y, v_x)

The paper leaves M' undefined and uses the SNR to accept a reading: here M' is M where the SNR
reaches a threshold, else 0; without any there is no bearing.

An ideal diode reads max(0, cos) of the angle to the lamp. Then the weighted mean is exact at every
angle for any even ring of four or more, 4, 8 and 16 among them: of each opposite pair exactly one
diode sees the lamp and both have the same n n^T, so the sum of n n^T over the lit ones is half of
that over the ring, (N/4) times the identity, and v points at the lamp. A common pedestal (diffuse
light) cancels, as the axes sum to zero. Gating breaks both, and so do another response, unequal
gains and reflections.

The drone steers by the fit of `lta_vlc.direction_fit`, which allows for these: `lta light
calibrate` measures gains and response, which it takes from the vehicle file. One direction does
not determine the range: that is a prior, or follows from the strength.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import Any, Final, final, NamedTuple

from lta_config.compilation.compiler import compile_functions
from lta_config.settings import setting, Settings
from lta_model.sensors.photodiode import DiodeRing
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction_fit import DirectionFit, fit_direction
from lta_vlc.reading_model import DiodeFitInputs, DirectionPrior, FIT_SCRATCH
import numpy as np
from numpy.typing import NDArray

# Sensor noise is far above this; a shorter vector is rounding around a perfectly even ring.
SHORTEST_VECTOR = 1e-9
# White noise whose quiet bins have the mean magnitude m moves an amplitude by this much of m: the
# quiet bins are Rayleigh distributed.
RAYLEIGH_SHARE: Final = math.sqrt(2.0 / math.pi)
LEAST_DEVIATION: Final = 1e-3  # smallest standard deviation of a prior [rad, 1/m]
OFF_AXIS_COSINE = 0.8  # mean cosine at which a Lambertian beam leaves a lamp that is flown to
OFF_AXIS_DEVIATION = 0.15  # relative, of a range by strength: the beam's angle is not known


@final
@dataclass(frozen=True, slots=True)
class Bearing:
    """The direction to a beacon in the body frame."""

    # The paper's vector, not normalised; about 1/2 long in direct light with cosine diodes,
    # shorter with diffuse light
    x: float
    y: float
    # Counter-clockwise from forward, and its standard deviation by sensor noise [rad]
    angle: float
    deviation: float


def weighted_mean_bearing(
    amplitudes: tuple[float, ...],
    snrs: tuple[float, ...],
    cosines: tuple[float, ...],
    sines: tuple[float, ...],
    threshold: float,
) -> tuple[bool, float, float, float, float]:
    """
    Return the paper's bearing vector, its direction and the direction's standard deviation.

    Plain scalars and tuples, so that it compiles with numba unchanged.

    Parameters
    ----------
    amplitudes, snrs : tuple of float
        Peak and signal-to-noise ratio of each diode.
    cosines, sines : tuple of float
        Diode axes in the body frame.
    threshold : float
        SNR from which a diode is used.

    Returns
    -------
    found : bool
        Whether there is a bearing; everything else is zero without one.
    x, y : float
        The vector, in units of the weights.
    angle, deviation : float
        Its direction and standard deviation. [rad]

    Notes
    -----
    d theta / d M_i = sin(phi_i - theta) / |sum M' n|. White noise whose quiet bins have the mean
    magnitude m moves the peak by m sqrt(2/pi) along its own phase (the quiet bins are Rayleigh
    distributed), and m = M_i / SNR_i. The error of a gated diode is its whole reading.

    """
    total = 0.0
    forward = 0.0
    left = 0.0
    for i in range(len(amplitudes)):
        # The paper's gate: M' is M above the threshold, else 0
        if snrs[i] >= threshold:
            total += amplitudes[i]
            forward += amplitudes[i] * cosines[i]
            left += amplitudes[i] * sines[i]
    length = math.hypot(forward, left)
    # Also true for NaN: evenly lit, or no diode above the threshold
    if not length > SHORTEST_VECTOR * total:
        return False, 0.0, 0.0, 0.0, 0.0
    variance = 0.0
    for i in range(len(amplitudes)):
        error = amplitudes[i]
        if snrs[i] >= threshold:
            error *= RAYLEIGH_SHARE / snrs[i]
        # sin(phi_i - theta)
        across = (sines[i] * forward - cosines[i] * left) / length
        variance += (error * across / length) ** 2
    return True, forward / total, left / total, math.atan2(left, forward), math.sqrt(variance)


def estimate_bearing(peaks: Peaks, ring: DiodeRing, threshold: float) -> Bearing | None:
    """
    Return the bearing to a beacon, or None if no diode detects it or the ring is evenly lit.

    The deviation covers only noise that is independent between diodes; it is too small, since it
    omits reflections, unequal gains, another response, tilt and rotation during the block. The fit
    of `LampFinder` allows for the first three.
    """
    is_valid, x, y, angle, deviation = weighted_mean_bearing(
        tuple(peaks.amplitude.tolist()),
        tuple(peaks.snr.tolist()),
        ring.cosines,
        ring.sines,
        threshold,
    )
    return Bearing(x, y, angle, deviation) if is_valid else None


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
        """Angle counter-clockwise from forward [rad]."""
        return math.atan2(self.y, self.x)

    @property
    def elevation(self) -> float:
        """Angle above the plane of forward and left [rad]."""
        return math.atan2(self.z, math.sqrt(self.x * self.x + self.y * self.y))

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of azimuth and elevation, shape (2, 2) [rad2]."""
        cross = self.cross_variance
        return np.array([[self.azimuth_variance, cross], [cross, self.elevation_variance]])


@final
class LampPrior(Settings):
    """Prior on the lamp: one direction does not determine its range."""

    distance: float = setting(4.0, 'm', 0.1, 100.0)
    """Expected distance to the lamp."""
    distance_deviation: float = setting(3.0, 'm', 0.0, 100.0)
    """Standard deviation of the expected distance to the lamp."""
    height_deviation: float = setting(1.0, 'm', 0.0, 100.0)
    """Standard deviation of the height difference between lamp and drone."""
    intensity: float = setting(0.0, 'counts', 0.0, 1e9)
    """
    Reading of a nominal photodiode that faces the lamp from 1 m away on the lamp's axis; 0: not
    measured.
    """


@final
class LampEstimate(NamedTuple):
    """The lamp in the body frame FLU: position x, y, z [m] and its covariance xx to zz [m2]."""

    x: float
    y: float
    z: float
    xx: float
    xy: float
    xz: float
    yy: float
    yz: float
    zz: float


class LampDetection(NamedTuple):
    """What a block shows of the lamp; None where nothing is detected."""

    towards: Bearing | None = None  # the paper's vector
    direction: Direction | None = None  # by the fit, with its strength
    lamp: LampEstimate | None = None  # in the body frame


@final
class LampFinder:
    """
    Find the lamp with an array of diodes.

    Attributes
    ----------
    diodes : DiodeArray
        As given.

    """

    def __init__(self, diodes: DiodeArray) -> None:
        self.diodes, self._ring = diodes, diodes.ring
        self._inputs = build_fit_inputs(diodes, np.array)
        self._fit = compile_functions(fit_direction)[0]
        self._scratch = np.zeros(FIT_SCRATCH)

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first block waits for it."""
        # Arguments of the types used later, so that the right signature is compiled
        dark = np.zeros(len(self._inputs.gains))
        self.find_direction(Peaks(dark, dark + 1.0, dark, dark), 1.0, LampPrior())

    def find_lamp(self, peaks: Peaks, threshold: float, prior: LampPrior) -> LampDetection:
        """Return what a block shows of the wanted beacon; `threshold` is an SNR."""
        direction = self.find_direction(peaks, threshold, prior)
        return LampDetection(
            estimate_bearing(peaks, self._ring, threshold),
            direction,
            None if direction is None else estimate_lamp_position(direction, prior),
        )

    def find_direction(self, peaks: Peaks, threshold: float, prior: LampPrior) -> Direction | None:
        """
        Return the direction, or None if no diode detects the lamp or all read the same.

        One diode at least must reach the SNR `threshold`; the others also constrain the direction.
        Diodes with an SNR of 0 are spoilt and left out. `prior` is the prior on the lamp.
        """
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


def estimate_range(direction: Direction, prior: LampPrior) -> tuple[float, float]:
    """
    Return the distance to the lamp and its standard deviation [m].

    By the inverse square law if the lamp's strength was measured, else the prior.
    """
    # Not measured: strength says nothing about the range
    if not prior.intensity > 0.0:
        return prior.distance, prior.distance_deviation
    # Inverse-square law; OFF_AXIS_COSINE is the beam's loss off its axis
    distance = math.sqrt(prior.intensity * OFF_AXIS_COSINE / direction.strength)
    # d ~ S^(-1/2), so relative errors halve
    relative = 0.5 * direction.strength_deviation / direction.strength
    return distance, distance * math.sqrt(OFF_AXIS_DEVIATION**2 + relative**2)


def estimate_lamp_position(direction: Direction, prior: LampPrior) -> LampEstimate:
    """
    Return the lamp on the ray of its direction, uncertain mostly along that ray.

    To first order in the angles the error across the ray is distance times angle, so its variance
    is (distance^2 + its variance) times that of the angle. Not the exact moments of a sector: for
    an angle known worse than half a radian the true region is bent.
    """
    x, y, z = direction.x, direction.y, direction.z
    distance, deviation = estimate_range(direction, prior)
    along = deviation * deviation
    level = math.sqrt(x * x + y * y)
    a, b = -y / level, x / level  # to the left of the ray
    d, e = -z * x / level, -z * y / level  # and, with `level`, upwards
    # Second moment of the distance
    square = distance * distance + along
    left = square * direction.azimuth_variance * level * level
    up = square * direction.elevation_variance
    both = square * direction.cross_variance * level
    return LampEstimate(
        distance * x,
        distance * y,
        distance * z,
        along * x * x + left * a * a + up * d * d + 2.0 * both * a * d,
        along * x * y + left * a * b + up * d * e + both * (a * e + b * d),
        along * x * z + up * d * level + both * a * level,
        along * y * y + left * b * b + up * e * e + 2.0 * both * b * e,
        along * y * z + up * e * level + both * b * level,
        along * z * z + up * level * level,
    )
