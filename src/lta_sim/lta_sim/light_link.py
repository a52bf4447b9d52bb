# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Model the lamp's signal at the photodiode ring without simulating the ADC samples.

A block of N samples yields one magnitude A per diode and its signal-to-noise ratio A / m. Both
follow from the geometry at the middle of the block:

    A = |g (clip(r + c E) - clip(r)) + s sqrt(2 / N) (n1 + i n2)|,   m = s sqrt(pi / N) + l c E + h

E is the illuminance by the lamp as the diode reads it [lx], c the counts per lux, r the counts of
dark signal and steady light (c and r include the diode's own gain), g the magnitude of a unit wave
after amplifier, transform and peak search, l the leakage of a unit wave into the quiet bins, h
that of the mains flicker, s2 the variance of a sample (amplifier, shot noise, and 1/12 for
rounding), and n1, n2 standard normal. g, l and h come from the demodulator itself
(`build_light_link`). The light of other lamps adds its mean to the steady light, and its leakage
to the quiet bins.

Neglected: harmonics of other lamps at the beacon, jitter, clock drift, rotation of the drone
within a block, mains flicker where it is clipped or falls between bins, and the scatter of m
itself (about 3 % with 400 quiet bins).
"""

import math
from typing import NamedTuple

from lta_model.light.direct_light import DiodeResponse, LampBeam
from lta_model.light.field import LightField
from lta_model.light.flicker import BlockSampling, sample_lamp_wave, sample_mains_wave
from lta_model.light.readings import add_direct_readings
from lta_model.light.reflected_light import (
    DAYLIGHT_ROW,
    gather_indirect_light,
    LAMP_ROWS,
    UNIFORM_ROW,
)
from lta_model.light.scene_geometry import is_in_room, SceneGeometry
from lta_model.light.view import build_field_geometry, build_reflecting_beam
from lta_model.sensors.photodiode import noise_variances, PhotodiodeArray, voltage_sensitivity
from lta_sim.compiled_sensors import draw_normals, draw_uniforms, GAINS, LIGHT, SWEEP
from lta_vlc.demodulation import find_peaks
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.spectrum import amplitude_spectrum, plan_beacon_bins
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class LampSignal(NamedTuple):
    """The signal of one lamp in a light link."""

    counts: float  # per lux of the lamp, c
    gain: float
    leak: float  # l
    ramp: float  # magnitude at the beacon of a light that changes by one count in a block
    duty: float


class LightLink(NamedTuple):
    """Constants of the light link of one photodiode ring; the target lamp comes first."""

    lamps: tuple[LampBeam, ...]
    signals: tuple[LampSignal, ...]
    eye: DiodeResponse
    planes: tuple[tuple[float, float, float, float, float, float], ...]
    spread: float  # relative standard deviation of a diode's gain
    alive: tuple[float, ...]  # gain of each diode, 0 if it is dead
    hull: Vector
    around: SceneGeometry
    door: bool  # ambient light in the room only
    axes: tuple[tuple[float, float], ...]  # of the diodes along body x and y
    threshold: float  # SNR above which a diode is trusted
    dark: float  # [counts]
    top: float  # largest value of the ADC [counts]
    steady: float  # steady ambient light [counts]
    day: float  # counts per lux of daylight
    hum: float  # h [counts]
    ramp_noise: float  # of a light that changes by one count in a block, in the quiet bins
    variance: float  # of a sample without light [counts2]
    shot: float  # variance of a sample per count of light [counts]
    samples: float


def build_light_link(
    field: LightField,
    array: PhotodiodeArray,
    hull: Vector,
    settings: DemodulationSettings,
    rate: float,
    samples: int,
) -> LightLink:
    """
    Build the light link of a ring in a scene.

    The demodulator listens at its own frequency for a single lamp, and at the frequency of each
    of several lamps.
    """
    ambient = field.ambient
    # The ADC samples at its own clock; the demodulator assumes the nominal rate
    sampling = BlockSampling(rate * (1.0 + array.clock_error), samples)
    beacons = [lamp.wave.frequency for lamp in field.lamps]
    if len(beacons) == 1:
        beacons = [settings.frequency]
    plans = plan_beacon_bins(beacons, settings, rate, samples)
    quiet = plans[0].quiet  # the same for all beacons
    # Counts per volt
    scale = 2**array.adc_bits / array.adc_range
    amplifier, shot = noise_variances(array)
    lux = voltage_sensitivity(array, ambient.efficacy) * scale
    mains = amplitude_spectrum(sample_mains_wave(ambient, 0, sampling)[:, None])
    # Daylight that sweeps over a turning diode is nearly linear within a block
    ramp = amplitude_spectrum(np.linspace(-0.5, 0.5, samples)[:, None])
    signals = []
    for lamp, bins in zip(field.lamps, plans, strict=True):
        # Behind the amplifier's pole; the first value lies one sample before the block
        wave = sample_lamp_wave(lamp, 0, sampling, 1.0 / (2.0 * math.pi * array.bandwidth))[1:]
        spectrum = amplitude_spectrum(wave[:, None])
        signals.append(
            LampSignal(
                counts=voltage_sensitivity(array, lamp.efficacy) * scale,
                gain=float(find_peaks(spectrum, bins).amplitude[0]),
                leak=float(spectrum[quiet, 0].mean()),
                ramp=float(ramp[(bins.first + bins.last) // 2, 0]),
                duty=lamp.wave.duty,
            )
        )
    # Columns 0..2: position of a diode, 3..5: its axis, body frame
    axes = array.planes[:, 3:]
    daylight = field.any_daylight
    return LightLink(
        lamps=tuple(build_reflecting_beam(lamp, field) for lamp in field.lamps),
        signals=tuple(signals),
        eye=DiodeResponse(array.response, array.edge_cosine),
        planes=tuple(tuple(row) for row in array.planes.tolist()),
        spread=array.gain_spread,
        alive=tuple(array.diode_gains.tolist()),
        hull=hull,
        around=build_field_geometry(field),
        door=field.outside is not None,
        axes=tuple((x, y) for x, y in axes[:, :2].tolist()),
        threshold=settings.threshold,
        dark=array.dark_offset * scale,
        top=array.largest_reading,
        steady=ambient.steady * lux,
        day=0.0 if not daylight else voltage_sensitivity(array, daylight.efficacy) * scale,
        hum=ambient.mains * lux * float(mains[quiet, 0].mean()),
        ramp_noise=float(ramp[quiet, 0].mean()),
        # 1/12: variance of rounding to whole counts
        variance=amplifier * scale * scale + 1.0 / 12.0,
        shot=shot * scale,
        samples=float(samples),
    )


def write_ring_light(
    listening: LightLink, position: Vector, q: Quaternion, out: Array, scratch: Array
) -> None:
    """
    Write the light on the diodes at a pose, in the row order of `gather_indirect_light`.

    `position`, `q`: of the hull at the middle of the block [m, map]. `out`, shape (LAMPS + l, d):
    shares and illuminances [lx]. `scratch`: working memory of `scratch_size(l)` numbers.
    """
    write_reflections(listening, position, q, out, scratch)
    add_direct_light(listening, position, q, out)


def write_reflections(
    listening: LightLink, position: Vector, q: Quaternion, out: Array, scratch: Array
) -> None:
    """Write the light except the lamps' direct part; arguments as in `write_ring_light`."""
    lamps, eye, hull = listening.lamps, listening.eye, listening.hull
    gather_indirect_light(
        listening.around, lamps, eye, hull, position, q, listening.planes, out, scratch
    )
    x, y, z = position
    if listening.door and not is_in_room(listening.around, x, y, z):
        for diode in range(len(listening.planes)):
            out[UNIFORM_ROW, diode] = 0.0


def add_direct_light(listening: LightLink, position: Vector, q: Quaternion, out: Array) -> None:
    """Add the lamps' direct light at the diodes; arguments as in `write_ring_light`."""
    lamps, eye, hull = listening.lamps, listening.eye, listening.hull
    add_direct_readings(
        listening.around, lamps, eye, hull, position, q, listening.planes, out, LAMP_ROWS
    )


def expected_magnitude(
    listening: LightLink, signal: LampSignal, light: float, steady: float
) -> tuple[float, float, float]:
    """Return a diode's noise-free magnitude, its noise level m, and the standard deviation."""
    top, rest = listening.top, listening.dark + steady
    # Clipping at the top of the ADC's range reduces the swing
    swing = signal.gain * (min(rest + light, top) - min(rest, top))
    variance = listening.variance + listening.shot * (steady + signal.duty * light)
    # Mean magnitude of a noise bin (Rayleigh), plus the lamp's spectral leakage
    quiet = math.sqrt(math.pi * variance / listening.samples) + signal.leak * light
    return swing, quiet, math.sqrt(2.0 * variance / listening.samples)


def sample_magnitude(
    listening: LightLink, lamp: int, diode: int, read: Array, swept: float, seed: int, step: int
) -> tuple[float, float]:
    """
    Return the magnitude of a lamp that a diode measures in one block [counts], and its SNR.

    `read` comes from `write_ring_light`; `step` is the control step at which the block ends.
    """
    own, _ = draw_normals(seed, GAINS, 0, diode)
    # A dead diode has gain 0
    factor = listening.alive[diode] * max(1.0 + listening.spread * own, 0.0)
    if factor == 0.0:
        return 0.0, 0.0
    share = factor * read[UNIFORM_ROW, diode]
    steady = share * listening.steady + factor * read[DAYLIGHT_ROW, diode] * listening.day
    leakage = 0.0
    for other in range(len(listening.signals)):
        if other != lamp:
            of_other = listening.signals[other]
            counts = factor * of_other.counts * read[LAMP_ROWS + other, diode]
            steady += of_other.duty * counts
            leakage += of_other.leak * counts
    signal = listening.signals[lamp]
    light = factor * signal.counts * read[LAMP_ROWS + lamp, diode]
    swing, quiet, noise = expected_magnitude(listening, signal, light, steady)
    a, b = draw_normals(seed, LIGHT, step, diode)
    # The sweep of daylight adds at the phase of the lamp in a block: the same at all diodes, and
    # in all blocks of a flight, as blocks hold whole periods of the lamp
    change = factor * swept * listening.day
    phase = 2.0 * math.pi * draw_uniforms(seed, SWEEP, 0, 0)[0]
    real = swing + noise * a + signal.ramp * change * math.cos(phase)
    # Magnitude of signal plus complex noise (Rice distribution)
    magnitude = math.hypot(real, noise * b + signal.ramp * change * math.sin(phase))
    quiet += leakage + listening.hum * share + listening.ramp_noise * abs(change)
    return magnitude, magnitude / quiet
