# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Chance by counting, as on a GPU, and sensors that draw from it: those of a single flight."""

import math
from types import SimpleNamespace

from lta_config.topics import load_topic_table
from lta_flight.batch.batch_flight import build_sensors
from lta_model.light.reflected_light import LAMP_ROWS, scratch_size, UNIFORM_ROW
from lta_model.light.view import LightView
from lta_model.mass_properties import half_axes
from lta_model.rigid_body import height_and_tilt
from lta_model.scenario import load_scenario
from lta_model.sensors import imu, pressure
from lta_model.sensors import range as range_finder
from lta_model.vehicle import load_vehicle
from lta_sim import compiled_sensors as counted
from lta_sim.compiled_sensors import draw_normals, draw_uniforms, threefry
from lta_sim.light_link import build_light_link, sample_magnitude, write_ring_light
from lta_vlc.demodulation import demodulate_beacon, demodulate_block, Peaks, plan_bins
from lta_vlc.diodes import build_even_ring
from lta_vlc.lamp import estimate_bearing
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.spectrum import plan_beacon_bins
import numpy as np
import pytest

DRAWS = 4000


@pytest.mark.parametrize(
    ('key', 'counter', 'bits'),
    [
        ((0, 0), (0, 0), (0x6B200159, 0x99BA4EFE)),
        ((0xFFFFFFFF, 0xFFFFFFFF), (0xFFFFFFFF, 0xFFFFFFFF), (0x1CB996FC, 0xBB002BE7)),
        ((0x13198A2E, 0x03707344), (0x243F6A88, 0x85A308D3), (0xC4923A9C, 0x483DF7A0)),
    ],
)
def test_it_gives_the_known_answers_of_its_authors(key, counter, bits):
    # Random123, tests/kat_vectors, threefry2x32 with 20 rounds.
    assert threefry(*key, *counter) == bits


def test_normal_deviates_are_normal_and_those_of_other_streams_are_others():
    values = np.array([draw_normals(5, 2, k, 0) for k in range(DRAWS)])
    error = 1.0 / math.sqrt(DRAWS)
    np.testing.assert_allclose(values.mean(axis=0), 0.0, atol=4 * error)
    np.testing.assert_allclose(values.std(axis=0), 1.0, atol=4 * error)
    np.testing.assert_allclose((values**4).mean(axis=0), 3.0, atol=4 * math.sqrt(96) * error)
    others = [
        np.array([draw_normals(*name, k, lane)[0] for k in range(DRAWS)])
        for name, lane in (((6, 2), 0), ((5, 3), 0), ((5, 2), 1))
    ]
    for other in (values[:, 1], values[1:, 0], *others):
        assert abs(np.corrcoef(values[: len(other), 0], other)[0, 1]) < 4 * error


def test_uniform_numbers_are_between_their_ends():
    values = np.array([draw_uniforms(1, 0, k, 0) for k in range(DRAWS)])
    assert values.min() > 0.0
    assert values.max() < 1.0
    np.testing.assert_allclose(values.mean(axis=0), 0.5, atol=4 * math.sqrt(1 / 12 / DRAWS))


SEED, STEP = 11, 7
BLOCKS = 400
VEHICLE = load_vehicle('gtmab')
HULL = half_axes(VEHICLE.file.hull)
SENSORS = build_sensors(VEHICLE, 101325.0)
RING = build_even_ring(VEHICLE.diodes.count).ring
DIODES = tuple(np.arange(VEHICLE.diodes.count).tolist())
ERRORS = counted.draw_errors(SENSORS, SEED)


def giving(*deviates):
    """Return a generator that gives these."""
    return SimpleNamespace(
        standard_normal=lambda count=None: deviates[0] if count is None else np.array(deviates)
    )


def test_the_inertial_sensor_is_the_same():
    own = imu.ImuErrors(*ERRORS.imu)
    force, rates = (0.31, -0.2, 9.9), (0.01, 0.5, -12.0)  # the last beyond full scale
    deviates = [x for lane in (0, 1, 2) for x in draw_normals(SEED, counted.IMU, STEP, lane)]
    expected = np.array(deviates)
    imu.apply_errors((*force, *rates), imu.pack_errors(own), expected)
    told = counted.simulate_imu_reading(ERRORS, SEED, STEP, force, rates)
    assert np.ravel(told).tolist() == expected.tolist()


def test_its_errors_are_drawn_within_the_bounds_of_the_data_sheet():
    bounds = imu.error_bounds(imu.ImuSettings())
    drawn = [counted.draw_errors(SENSORS, seed) for seed in np.arange(500).tolist()]
    gains = np.array([errors.imu.gain for errors in drawn]) - 1.0
    offsets = np.array([errors.imu.offset for errors in drawn])
    for values, bound in ((gains, bounds.gain), (offsets, bounds.offset)):
        shares = values / np.array(bound)
        assert abs(shares).max() <= 1.0
        np.testing.assert_allclose(shares.std(axis=0), math.sqrt(1 / 3), rtol=0.12)
        assert abs(np.corrcoef(shares.T) - np.eye(6)).max() < 4 / math.sqrt(500)


@pytest.mark.parametrize('height', [0.36, 0.5, 2.0, 3.9, 4.5])
def test_the_range_finder_is_the_same(height):
    state = (0.0, 0.0, height, 0.02, -0.03, 0.1, 0.9943, 0, 0, 0, 0, 0, 0)
    settings = range_finder.RangeSettings()
    own = range_finder.RangeErrors(ERRORS.range_offset)
    outlook = height_and_tilt(state, SENSORS.range_place)
    deviate = draw_normals(SEED, counted.RANGE, STEP, 0)[0]
    told = range_finder.measure_range(settings, own, *outlook, giving(deviate))
    expected = told if math.isfinite(told) else math.nan
    np.testing.assert_equal(
        counted.simulate_range_reading(SENSORS, ERRORS, SEED, STEP, state), expected
    )


def test_the_barometer_is_the_same():
    own = pressure.PressureErrors(ERRORS.pressure_offset, ERRORS.drift)
    deviate = draw_normals(SEED, counted.PRESSURE, STEP, 0)[0]
    # Rolled by 90 degrees to the right: the left side, y, points up
    state = (0.0, 0.0, 0.7, math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5), 0, 0, 0, 0, 0, 0)
    place = (0.1, 0.2, -0.3)
    expected = pressure.measure_pressure(
        pressure.PressureSettings(floor=101325.0), own, 0.7 + 0.2, 3.0, giving(deviate)
    )
    sensors = SENSORS._replace(imu_place=place)
    assert counted.simulate_pressure_reading(sensors, ERRORS, SEED, STEP, state, 3.0) == expected


@pytest.mark.parametrize(
    'distance',
    [pytest.param(1.0, marks=pytest.mark.long), 3.0, pytest.param(7.0, marks=pytest.mark.long)],
)
def test_the_lamp_is_heard_as_through_blocks(distance):
    """
    Magnitude, SNR and bearing of many blocks against the chain of ADC and transform.

    The nose is elsewhere in each: a drone that stands still rounds alike in every block.
    """
    scene, light = load_scenario('lamp_room'), load_topic_table().light
    rate, settings, chance = light.sample_rate.si, DemodulationSettings(), np.random.default_rng(3)
    bins = plan_bins(settings, rate, light.samples)
    diodes = VEHICLE.diodes.model_copy(update={'gain_spread': 0.0})
    listening = build_light_link(scene.light_field, diodes, HULL, settings, rate, light.samples)
    x = scene.light_field.first_lamp.position[0] - distance
    told = []
    for k, half in enumerate(chance.uniform(0.1, 0.2, BLOCKS).tolist()):
        pose = (x, 0.0, 0.5, 0.0, 0.0, math.sin(half), math.cos(half))
        view = LightView(scene.light_field, VEHICLE, diodes)
        view.record_pose(pose)
        block = view.sample_light_block(k * 10**8, rate, light.samples, chance)
        silent = listening._replace(variance=0.0, shot=0.0)
        read = readings(LightView(scene.light_field, VEHICLE, diodes), pose)
        both = (demodulate_beacon(block, bins), heard(listening, read, k), heard(silent, read, k))
        angles = [estimate_bearing(p, RING, settings.threshold).angle for p in both]
        off = (angles[0] - angles[2], angles[1] - angles[2])
        told.append((*off, *(number.mean() for p in both[:2] for number in (p.amplitude, p.snr))))
    off, own, amplitude, snr, own_amplitude, own_snr = np.array(told).T
    np.testing.assert_allclose(own_amplitude.mean(), amplitude.mean(), rtol=2e-3)
    # What leaks and what is noise add up in the model, and as vectors in a bin.
    np.testing.assert_allclose(own_snr.mean(), snr.mean(), rtol=0.05)
    assert abs(off.mean()) < 4 * off.std() / math.sqrt(BLOCKS)  # of what scatters by chance
    np.testing.assert_allclose(own.std(), off.std(), rtol=4 / math.sqrt(2 * BLOCKS))


def readings(view, pose):
    """Return what a ring reads at a pose, as `write_ring_light` writes it."""
    light = view.compute_diode_readings([pose])
    read = np.zeros((LAMP_ROWS + len(view.field.lamps), len(DIODES)))
    read[UNIFORM_ROW] = light.steady[0] / view.field.ambient.steady
    read[LAMP_ROWS:] = light.modulated[:, 0]
    return read


def test_each_of_three_lamps_is_heard_as_through_blocks():
    """Amplitude and SNR at every frequency, where all three lamps of a route are in sight."""
    scene, light = load_scenario('warehouse'), load_topic_table().light
    rate, field, chance = light.sample_rate.si, scene.light_field, np.random.default_rng(4)
    first, *others = (lamp.wave.frequency for lamp in field.lamps)
    settings = DemodulationSettings(frequency=first, others=tuple(others))
    bins = plan_beacon_bins(settings.beacons, settings, rate, light.samples)
    diodes = VEHICLE.diodes.model_copy(update={'gain_spread': 0.0})
    listening = build_light_link(field, diodes, HULL, settings, rate, light.samples)
    told = []
    for k, half in enumerate(chance.uniform(-0.1, 0.1, 20).tolist()):
        pose = (-6.0, 0.5, 0.5, 0.0, 0.0, math.sin(half), math.cos(half))
        view = LightView(field, VEHICLE, diodes)
        view.record_pose(pose)
        block = view.sample_light_block(k * 10**8, rate, light.samples, chance)
        read = readings(LightView(field, VEHICLE, diodes), pose)
        own = [heard(listening, read, k, lamp) for lamp in (0, 1, 2)]
        told.append([
            [(p.amplitude.max(), p.snr.max()) for p in each]
            for each in (demodulate_block(block, bins).peaks, own)
        ])  # fmt: skip
    blocks, model = np.array(told).mean(axis=0)
    assert blocks[:, 1].min() > settings.threshold
    np.testing.assert_allclose(model[:, 0], blocks[:, 0], rtol=0.01)
    # The model adds what leaks from each lamp to the noise; in a bin they add as vectors
    np.testing.assert_allclose(model[:, 1], blocks[:, 1], rtol=0.08)


def test_a_batch_reads_the_light_of_a_view():
    scene, pose = load_scenario('lamp_room'), (1.0, 0.5, 0.5, 0.02, -0.03, 0.6, 0.8)
    listening = build_light_link(
        scene.light_field, VEHICLE.diodes, HULL, DemodulationSettings(), 1e4, 1000
    )
    own = np.empty((LAMP_ROWS + 1, len(DIODES)))
    write_ring_light(listening, pose[:3], pose[3:], own, np.empty(scratch_size(1)))
    told = readings(LightView(scene.light_field, VEHICLE), pose)
    np.testing.assert_allclose(
        own[[UNIFORM_ROW, LAMP_ROWS]], told[[UNIFORM_ROW, LAMP_ROWS]], rtol=1e-12
    )


def heard(listening, read, k, lamp=0):
    """Return what a ring hears of a lamp in one block."""
    pairs = [sample_magnitude(listening, lamp, i, read, 0.0, SEED, k) for i in DIODES]
    amplitude, snr = np.array(pairs).T
    return Peaks(amplitude, snr, np.zeros_like(snr), np.ones_like(snr))


def test_eddies_are_stationary_at_the_start():
    """Variances and the covariance that `effects.turbulence` states, within 4 sigma."""
    count = 4000
    drawn = np.array([counted.draw_turbulence_memory(seed) for seed in np.arange(count).tolist()])
    assert abs(drawn.mean(axis=0)).max() < 4 / math.sqrt(count)
    expected = np.zeros((5, 5))
    expected[0, 0] = 1.0
    for k in (1, 3):
        expected[k : k + 2, k : k + 2] = [[0.5, 0.25], [0.25, 0.25]]
    assert abs(np.cov(drawn.T) - expected).max() < 4 * math.sqrt(2 / count)
