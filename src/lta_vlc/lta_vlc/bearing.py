"""
The bearing to a beacon from a ring of photodiodes: the paper's weighted mean.

Body frame FLU: azimuth 0 is forward and grows counter-clockwise. With diode axes
n_i = (cos phi_i, sin phi_i) and peak amplitudes M_i,

    v = sum(M'_i n_i) / sum(M'_i),  theta = atan2(v_y, v_x)

The paper leaves M' undefined and says that the SNR decides whether a reading is used: here M' is
M where the SNR reaches a threshold, else 0, and there is no bearing where all are gated out.

An ideal diode reads max(0, cos) of the angle to the lamp. With it the weighted mean is exact at
every angle for any even ring of four or more, 4, 8 and 16 among them: of each opposite pair
exactly one diode sees the lamp and both have the same n n^T, so the sum of n n^T over those that
see it is half of that over the ring, (N/4) times the identity, and v points at the lamp. A common
pedestal (diffuse light) cancels, as the axes sum to zero. Gates break both, and so do a response
other than the cosine, unequal gains and light from walls.
"""

from dataclasses import dataclass
import math
from typing import final

from lta_model.diode_ring import DiodeRing
from lta_vlc.demodulation import Peaks

# Sensor noise is far above this; a shorter vector is rounding around a perfectly even ring.
SHORTEST = 1e-9


@final
@dataclass(frozen=True, slots=True)
class Bearing:
    """
    The direction to a beacon in the body frame.

    Parameters
    ----------
    x, y : float
        The paper's un-normalised vector; its length is 1/2 or so in pure direct light from a
        ring of cosine diodes and falls towards 0 as diffuse light grows.
    angle : float
        Direction, counter-clockwise from forward. [rad]
    deviation : float
        Standard deviation of the angle from sensor noise. [rad]

    """

    x: float
    y: float
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
    amplitudes, snrs : tuple of float, one a diode
        Peak and signal-to-noise ratio.
    cosines, sines : tuple of float, one a diode
        Axes in the body frame.
    threshold : float
        SNR from which a diode is believed.

    Returns
    -------
    found : bool
        Whether there is a bearing; everything else is zero without one.
    x, y : float
        The un-normalised vector, in units of the weights.
    angle, deviation : float
        Its direction and standard deviation. [rad]

    Notes
    -----
    d theta / d M_i = sin(phi_i - theta) / |sum M' n|. White noise whose quiet bins have the mean
    magnitude m moves the peak by m sqrt(2/pi) along its own phase (the quiet bins are Rayleigh
    distributed), and m = M_i / SNR_i. A diode that is gated out counts with its whole reading as
    its error, since that is what the gate removed.

    """
    total = 0.0
    forward = 0.0
    left = 0.0
    for i in range(len(amplitudes)):
        if snrs[i] >= threshold:
            total += amplitudes[i]
            forward += amplitudes[i] * cosines[i]
            left += amplitudes[i] * sines[i]
    length = math.hypot(forward, left)
    if not length > SHORTEST * total:
        return False, 0.0, 0.0, 0.0, 0.0
    variance = 0.0
    for i in range(len(amplitudes)):
        error = amplitudes[i]
        if snrs[i] >= threshold:
            error *= math.sqrt(2.0 / math.pi) / snrs[i]
        across = (sines[i] * forward - cosines[i] * left) / length
        variance += (error * across / length) ** 2
    return True, forward / total, left / total, math.atan2(left, forward), math.sqrt(variance)


def estimate_bearing(peaks: Peaks, ring: DiodeRing, threshold: float) -> Bearing | None:
    """
    Return the bearing to a beacon, or None where no diode hears it or the ring is evenly lit.

    Parameters
    ----------
    peaks : Peaks
        What each diode sees, in the order of the ring.
    ring : Ring
        The diodes' axes.
    threshold : float
        SNR from which a diode is believed.

    Notes
    -----
    The deviation holds only noise that is independent between diodes. It leaves out reflections,
    unequal gains, a response other than the cosine, tilt and the turning of the drone within
    the block, so that it is too small. The fit of `lta_vlc.direction` allows for the first three.

    """
    found, x, y, angle, deviation = weighted_mean_bearing(
        tuple(peaks.amplitude.tolist()),
        tuple(peaks.snr.tolist()),
        ring.cosines,
        ring.sines,
        threshold,
    )
    return Bearing(x, y, angle, deviation) if found else None
