# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the direction to a lamp and its position, by the fit of `lta_vlc.direction_fit`.

`lta light calibrate` measures gains and response of the photodiodes, which the fit takes from the
vehicle file.
"""

from collections.abc import Callable, Sequence
import math
from typing import Any, Final, final, NamedTuple

from lta_config.compilation.compiler import compile_functions
from lta_vlc.bearing import Bearing, estimate_bearing
from lta_vlc.demodulation import Peaks
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction_fit import DirectionFit, fit_direction
from lta_vlc.lamp import Direction, estimate_lamp_position, LampEstimate, LampPrior
from lta_vlc.reading_model import DiodeFitInputs, DirectionPrior, FIT_SCRATCH
import numpy as np

# White noise whose quiet bins have the mean magnitude m moves an amplitude by this much of m: the
# quiet bins are Rayleigh distributed.
RAYLEIGH_SHARE: Final = math.sqrt(2.0 / math.pi)
LEAST_DEVIATION: Final = 1e-3  # smallest standard deviation of a prior [rad, 1/m]


@final
class DirectionFinder:
    """Find directions with one array of diodes."""

    def __init__(self, diodes: DiodeArray) -> None:
        self._inputs = build_fit_inputs(diodes, np.array)
        self._fit = compile_functions(fit_direction)[0]
        self._scratch = np.zeros(FIT_SCRATCH)

    def prepare(self) -> None:
        """Compile the fit, or load it from disk, before the first block waits for it."""
        # Arguments of the types used later, so that the right signature is compiled
        dark = np.zeros(len(self._inputs.gains))
        self.find(Peaks(dark, dark + 1.0, dark, dark), 1.0, LampPrior())

    def find(self, peaks: Peaks, threshold: float, prior: LampPrior) -> Direction | None:
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


class LampDetection(NamedTuple):
    """The paper's vector, and the lamp in the body frame; None where nothing is detected."""

    towards: Bearing | None = None
    lamp: LampEstimate | None = None


@final
class LampFinder:
    """Find the lamp with an array of diodes."""

    def __init__(self, diodes: DiodeArray) -> None:
        self.diodes = diodes
        self._finder = DirectionFinder(diodes)

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
