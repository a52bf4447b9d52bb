"""
How well each lamp is heard over each cell while all lamps are on, as compiled plain functions.

With c counts a lux, E the light of a lamp and F that of all others on one diode, rest r and top t
of the converter, and the demodulator's g and l (`lta_sim.heard_lamp`):

    A = g (clip(r + c F + c E) - clip(r + c F)),   m = s sqrt(pi / N) + l c E + h + sum q c F

q is what a unit wave of another lamp leaves in this one's quiet bins. Where they fill the
converter, the others count as on all the time. Where they leave more in this lamp's window than a
part of A, it is not told from them, and not heard on that diode.
"""

import math

from lta_analysis.light.plan.rays import hidden
from lta_sim.effects.protocol import Vector
from lta_sim.lambertian import Array, Beam, lit


def ratio(
    own: float,
    others: float,
    disturbed: float,
    gain: float,
    leak: float,
    hum: float,
    rest: float,
    top: float,
    variance: float,
    shot: float,
    samples: float,
) -> tuple[float, float]:
    """
    Return amplitude and SNR that the light of a lamp comes to, without the scatter of blocks.

    Parameters
    ----------
    own, others : float
        Counts of this lamp and of all others while they are on.
    disturbed : float
        What the others leave in the bins that tell the noise. [counts]
    gain, leak, hum, rest, top, variance, shot, samples : float
        As `Listening` has them; `shot` is what a count of light adds on average.

    """
    below = min(rest + others, top)
    swing = gain * (min(rest + others + own, top) - below)
    noise = math.sqrt(math.pi * (variance + shot * (own + others)) / samples)
    return swing, swing / (noise + leak * own + hum + disturbed)


def heard_together(
    lamps: Array,
    visible: Array,
    cells: Array,
    planes: Array,
    half_axes: Vector,
    headings: Array,
    numbers: tuple[float, float, float, float, float, float],
    each: Array,
    window: Array,
    quiet: Array,
    pure: float,
    light: Array,
    out: Array,
) -> None:
    """
    Write the SNR of each lamp over each cell on its best diode, at its worst heading.

    Parameters
    ----------
    lamps : ndarray, shape (l, 10)
        In the order of `Beam`, without any room.
    visible : ndarray of bool, shape (l, m)
        Which lamp no wall hides from which cell.
    cells : ndarray, shape (m, 3)
        Hull centres. [m]
    planes, half_axes, headings
        As `rays.extremes` takes them.
    numbers : tuple of 6 floats
        Counts a lux, rest, top, variance, what a count of light adds to it, and samples.
    each : ndarray, shape (l, 3)
        Gain, leak and hum at each lamp's frequency.
    window, quiet : ndarray, shape (l, l)
        From `crosstalk`.
    pure : float
        How often its amplitude a lamp must read what others leave in its window.
    light : ndarray, shape (l,)
        Room for the light of the lamps on one diode.
    out : ndarray, shape (l, m)
        The SNR.

    """
    counts, rest, top, variance, shot, samples = numbers
    count = lamps.shape[0]
    best = light.copy()
    for m in range(cells.shape[0]):
        for k in range(count):
            out[k, m] = math.inf if visible[k, m] else 0.0
        for h in range(headings.shape[0]):
            cosine, sine = headings[h, 0], headings[h, 1]
            for k in range(count):
                best[k] = 0.0
            for d in range(planes.shape[0]):
                spot = (planes[d, 0], planes[d, 1], planes[d, 2])
                axis = (planes[d, 3], planes[d, 4], planes[d, 5])
                point = (
                    cells[m, 0] + cosine * spot[0] - sine * spot[1],
                    cells[m, 1] + sine * spot[0] + cosine * spot[1],
                    cells[m, 2] + spot[2],
                )
                normal = (
                    cosine * axis[0] - sine * axis[1],
                    sine * axis[0] + cosine * axis[1],
                    axis[2],
                )
                total = 0.0
                for k in range(count):
                    light[k] = 0.0
                    if visible[k, m]:
                        lamp = lamps[k]
                        x, y, z = lamp[0] - point[0], lamp[1] - point[1], lamp[2] - point[2]
                        if x * normal[0] + y * normal[1] + z * normal[2] > 0.0:
                            ray = (cosine * x + sine * y, cosine * y - sine * x, z)
                            if not hidden(spot, ray, half_axes):
                                light[k] = counts * lit(beam_of(lamp), point, normal)
                    total += light[k]
                for k in range(count):
                    if light[k] > 0.0:
                        disturbed, spilt = 0.0, 0.0
                        for j in range(count):
                            disturbed += quiet[k, j] * light[j]
                            spilt += window[k, j] * light[j]
                        swing, snr = ratio(
                            light[k], total - light[k], disturbed, each[k, 0], each[k, 1],
                            each[k, 2], rest, top, variance, shot, samples,
                        )  # fmt: skip
                        if swing >= pure * spilt and snr > best[k]:
                            best[k] = snr
            for k in range(count):
                out[k, m] = min(out[k, m], best[k])


def beam_of(row: Array) -> Beam:
    """Return a lamp from its numbers, in the order of `Beam`."""
    return Beam(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9]
    )  # fmt: skip
