"""
Model the lamp's signal at the photodiode ring without simulating the ADC samples.

A block of N samples yields one magnitude per diode and its ratio to the noise.
Both follow from the geometry at the middle of the block:

    A = |g (clip(r + c E) - clip(r)) + s sqrt(2 / N) (n1 + i n2)|,   m = s sqrt(pi / N) + l c E + h

E is the light of the lamp as the diode reads it [lx], c counts a lux, r the counts of the dark
and of steady light, both times the diode's own gain, g the magnitude of a unit wave behind
amplifier, transform and search, l what a unit wave leaves in the quiet bins, h what the flicker
of the mains leaves there, s2 the variance of a sample (amplifier, shot noise, and 1/12 for
rounding) and n1, n2 normal. SNR = A / m. g, l and h are the demodulator's own
(`build_light_link`).

Left out: other lamps, jitter, the drift of clocks, the turning of the drone within a block, the
flicker of the mains where it is clipped or falls between bins, and the scatter of m itself (some
3 % with 400 quiet bins).
"""

import math
from typing import NamedTuple

from lta_model.light.block_motion import add_direct_readings
from lta_model.light.field import LightField
from lta_model.light.flicker import BlockSampling, sample_lamp_wave, sample_mains_wave
from lta_model.light.lambertian import DiodeResponse, LampBeam
from lta_model.light.ray_bundles import DAY, LAMPS, SHARE
from lta_model.light.ray_integration import gather_indirect_light
from lta_model.light.reflections import build_field_geometry, build_reflecting_beam
from lta_model.light.scene_geometry import is_in_room, SceneGeometry
from lta_model.sensors.photodiode import noise_variances, PhotodiodeArray, voltage_sensitivity
from lta_sim.compiled_sensors import GAINS, LIGHT
from lta_sim.counter_rng import draw_normals
from lta_vlc.demodulation import find_peaks, plan_bins
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.spectrum import amplitude_spectrum
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class LightLink(NamedTuple):
    """Constants of the light link of one ring."""

    lamp: LampBeam
    eye: DiodeResponse
    planes: tuple[tuple[float, float, float, float, float, float], ...]
    spread: float
    alive: tuple[float, ...]
    hull: Vector
    around: SceneGeometry
    door: bool  # ambient light in the room only
    axes: tuple[tuple[float, float], ...]  # of the diodes along body x and y
    threshold: float
    counts: float
    dark: float
    top: float
    steady: float
    day: float
    gain: float
    leak: float
    hum: float
    duty: float
    variance: float
    shot: float
    samples: float


def build_light_link(
    field: LightField,
    array: PhotodiodeArray,
    hull: Vector,
    settings: DemodulationSettings,
    rate: float,
    samples: int,
) -> LightLink:
    """Return the light link of a ring in a scene."""
    lamp, ambient = field.first_lamp, field.ambient
    sampling = BlockSampling(rate * (1.0 + array.clock_error), samples)
    wave = sample_lamp_wave(lamp, 0, sampling, 1.0 / (2.0 * math.pi * array.bandwidth))[1:]
    bins = plan_bins(settings, rate, samples)
    spectrum = amplitude_spectrum(wave[:, None])
    gain = float(find_peaks(spectrum, bins).amplitude[0])
    scale = 2**array.adc_bits / array.adc_range
    volts = voltage_sensitivity(array)
    amplifier, shot = noise_variances(array)
    lux = volts / ambient.efficacy * scale
    mains = amplitude_spectrum(sample_mains_wave(ambient, 0, sampling)[:, None])
    axes = array.planes[:, 3:]
    daylight = field.daylight if field.outside is None else field.outside.daylight
    return LightLink(
        lamp=build_reflecting_beam(lamp, field),
        eye=DiodeResponse(array.response, array.edge_cosine),
        planes=tuple(tuple(row) for row in array.planes.tolist()),
        spread=array.gain_spread,
        alive=tuple(array.diode_gains.tolist()),
        hull=hull,
        around=build_field_geometry(field),
        door=field.outside is not None,
        axes=tuple((x, y) for x, y in axes[:, :2].tolist()),
        threshold=settings.threshold,
        counts=volts / lamp.efficacy * scale,
        dark=array.dark_offset * scale,
        top=2.0**array.adc_bits - 1.0,
        steady=ambient.steady * lux,
        day=0.0 if daylight is None else volts / daylight.efficacy * scale,
        gain=gain,
        leak=float(spectrum[bins.quiet, 0].mean()),
        hum=ambient.mains * lux * float(mains[bins.quiet, 0].mean()),
        duty=lamp.wave.duty,
        variance=amplifier * scale * scale + 1.0 / 12.0,
        shot=shot * scale,
        samples=float(samples),
    )


def write_ring_light(
    listening: LightLink, position: Vector, q: Quaternion, out: Array, scratch: Array
) -> None:
    """
    Write what the diodes read at a pose, in the rows of `gather_indirect_light`.

    Parameters
    ----------
    listening : Listening
        Lamp and ring.
    position, q : tuple of float
        Of the hull at the middle of the block. [m, map]
    out : ndarray, shape (LAMPS + 1, d)
        Shares and lux.
    scratch : sequence of float
        `scratch_for(1)` numbers to write on.

    """
    write_reflections(listening, position, q, out, scratch)
    add_direct_light(listening, position, q, out)


def write_reflections(
    listening: LightLink, position: Vector, q: Quaternion, out: Array, scratch: Array
) -> None:
    """Write the light without the lamp's direct part; arguments as in `write_ring_light`."""
    lamps, eye, hull = (listening.lamp,), listening.eye, listening.hull
    gather_indirect_light(
        listening.around, lamps, eye, hull, position, q, listening.planes, out, scratch
    )
    x, y, z = position
    if listening.door and not is_in_room(listening.around, x, y, z):
        for diode in range(len(listening.planes)):
            out[SHARE, diode] = 0.0


def add_direct_light(listening: LightLink, position: Vector, q: Quaternion, out: Array) -> None:
    """Add the lamp's direct light at the diodes; arguments as in `write_ring_light`."""
    lamps, eye, hull = (listening.lamp,), listening.eye, listening.hull
    add_direct_readings(
        listening.around, lamps, eye, hull, position, q, listening.planes, out, LAMPS
    )


def expected_magnitude(
    listening: LightLink, light: float, steady: float
) -> tuple[float, float, float]:
    """Return a diode's magnitude of the lamp without noise, and the noise level."""
    top, rest = listening.top, listening.dark + steady
    swing = listening.gain * (min(rest + light, top) - min(rest, top))
    variance = listening.variance + listening.shot * (steady + listening.duty * light)
    quiet = math.sqrt(math.pi * variance / listening.samples) + listening.leak * light
    return swing, quiet, math.sqrt(2.0 * variance / listening.samples)


def sample_magnitude(
    listening: LightLink, diode: int, read: Array, seed: int, step: int
) -> tuple[float, float]:
    """
    Return the magnitude that a diode reads in one block [counts], and its SNR.

    Parameters
    ----------
    listening : Listening
        Lamp and ring.
    diode : int
        Which, from 0.
    read : ndarray
        From `write_ring_light`.
    seed, step : int
        Of the flight, and the control step at which the block ends.

    """
    own, _ = draw_normals(seed, GAINS, 0, diode)
    factor = listening.alive[diode] * max(1.0 + listening.spread * own, 0.0)
    if factor == 0.0:
        return 0.0, 0.0
    share = factor * read[SHARE, diode]
    steady = share * listening.steady + factor * read[DAY, diode] * listening.day
    light = factor * listening.counts * read[LAMPS, diode]
    swing, quiet, noise = expected_magnitude(listening, light, steady)
    a, b = draw_normals(seed, LIGHT, step, diode)
    told = math.hypot(swing + noise * a, noise * b)
    return told, told / (quiet + listening.hum * share)
