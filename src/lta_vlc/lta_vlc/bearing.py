# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Bearing to a beacon from a ring of photodiodes: the paper's weighted mean.

Body frame FLU: azimuth 0 is forward and grows counter-clockwise. With diode axes
n_i = (cos phi_i, sin phi_i) and peak amplitudes M_i,

    v = sum(M'_i n_i) / sum(M'_i),  theta = atan2(v_y, v_x)

The paper leaves M' undefined and uses the SNR to accept a reading: here M' is M where the SNR
reaches a threshold, else 0; without any there is no bearing.

An ideal diode reads max(0, cos) of the angle to the lamp. Then the weighted mean is exact at every
angle for any even ring of four or more, 4, 8 and 16 among them: of each opposite pair exactly one
diode sees the lamp and both have the same n n^T, so the sum of n n^T over the lit ones is half of
that over the ring, (N/4) times the identity, and v points at the lamp. A common pedestal (diffuse
light) cancels, as the axes sum to zero. Gating breaks both, and so do another response, unequal
gains and reflections.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_model.sensors.photodiode import DiodeRing
from lta_vlc.demodulation import Peaks

# Sensor noise is far above this; a shorter vector is rounding around a perfectly even ring.
SHORTEST_VECTOR = 1e-9


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
            # Standard deviation of the peak, from the mean of Rayleigh distributed quiet bins
            error *= math.sqrt(2.0 / math.pi) / snrs[i]
        # sin(phi_i - theta)
        across = (sines[i] * forward - cosines[i] * left) / length
        variance += (error * across / length) ** 2
    return True, forward / total, left / total, math.atan2(left, forward), math.sqrt(variance)


def estimate_bearing(peaks: Peaks, ring: DiodeRing, threshold: float) -> Bearing | None:
    """
    Return the bearing to a beacon, or None if no diode detects it or the ring is evenly lit.

    The deviation covers only noise that is independent between diodes; it is too small, since it
    omits reflections, unequal gains, another response, tilt and rotation during the block. The fit
    of `lta_vlc.direction` allows for the first three.
    """
    is_valid, x, y, angle, deviation = weighted_mean_bearing(
        tuple(peaks.amplitude.tolist()),
        tuple(peaks.snr.tolist()),
        ring.cosines,
        ring.sines,
        threshold,
    )
    return Bearing(x, y, angle, deviation) if is_valid else None
