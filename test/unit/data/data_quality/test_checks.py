# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The trust checks, by hand-made channels with known faults."""

from dataclasses import replace

from lta_config.files import find_file, load_yaml
from lta_data.data_quality.recording import Severity
from lta_data.data_quality.registry import run_checks
from lta_data.flight import Channel, Flight
import numpy as np
import pytest
import yaml

GYRO, FORCE = 'imu/angular_velocity', 'imu/linear_acceleration'


def recording(**channels):
    """Return a recording of channels by 'topic/field', each a pair of times and values."""
    made = {
        n: Channel(n, '', np.asarray(t), np.asarray(v, float)) for n, (t, v) in channels.items()
    }
    return Flight(made)


def resting(seed=0, count=1000):
    """Return a resting IMU of 100 Hz with the noise of a data sheet."""
    rng = np.random.default_rng(seed)
    time = np.arange(count) * 0.01
    rates = {f'{GYRO}.{axis}': (time, rng.normal(0.0, 1.4e-3, count)) for axis in 'xyz'}
    level = {'x': 0.0, 'y': 0.0, 'z': 9.80665}
    force = {f'{FORCE}.{a}': (time, rng.normal(g, 0.01, count)) for a, g in level.items()}
    return rates | force


def kinds(flight):
    """Return kinds and channels of what was found."""
    return {(finding.kind, finding.channel) for finding in run_checks(flight).findings}


def test_a_resting_sensor_is_clean_and_what_cannot_be_judged_is_said():
    report = run_checks(recording(**resting()))
    assert report.findings == ()
    assert any('cannot be judged' in sentence for sentence in report.unjudged)


def test_an_empty_recording_has_no_findings():
    assert run_checks(Flight({})).findings == ()


def test_a_constant_axis_is_named_and_an_unfilled_vector_is_a_note():
    data = resting()
    time = data[f'{GYRO}.x'][0]
    data[f'{GYRO}.y'] = (time, np.full(len(time), 0.25))
    assert ('constant', f'{GYRO}.y') in kinds(recording(**data))
    for axis in 'xyz':
        data[f'{GYRO}.{axis}'] = (time, np.zeros(len(time)))
    (found,) = run_checks(recording(**data)).findings
    assert (found.channel, found.severity, found.is_grave) == (GYRO, Severity.NOTE, False)


def test_an_identity_quaternion_is_an_attitude_that_is_set():
    data = resting()
    time = data[f'{GYRO}.x'][0]
    for angle in ('yaw', 'pitch', 'roll'):
        data[f'imu/orientation.{angle}'] = (time, np.zeros(len(time)))
    found = run_checks(recording(**data)).findings
    (note,) = [each for each in found if each.channel == 'imu/orientation']
    assert note.severity is Severity.NOTE
    assert note.evidence.startswith('The attitude is the identity in all')


def test_an_angle_that_the_log_lacks_is_said_to_be_missing():
    """An import takes it as zero: no sensor is stuck. One that is stuck elsewhere is told so."""
    data = resting()
    time = data[f'{GYRO}.x'][0]
    rng = np.random.default_rng(4)
    for angle in ('yaw', 'roll'):
        data[f'imu/orientation.{angle}'] = (time, rng.normal(0.1, 1e-3, len(time)))
    data['imu/orientation.pitch'] = (time, np.zeros(len(time)))
    (found,) = run_checks(recording(**data)).findings
    assert found.channel == 'imu/orientation.pitch'
    assert 'the angle was not recorded' in found.evidence
    data['imu/orientation.pitch'] = (time, np.full(len(time), 0.2))
    (found,) = run_checks(recording(**data)).findings
    assert 'the noise of a real sensor' in found.evidence


def test_a_stop_is_found_where_it_is():
    data = resting()
    time, values = data[f'{GYRO}.x']
    values[400:450] = values[400]
    (found,) = run_checks(recording(**data)).findings
    assert (found.kind, found.channel) == ('frozen', f'{GYRO}.x')
    assert (found.from_s, found.to_s) == pytest.approx((time[400], time[449]))
    assert found.values['readings'] == 50


def test_a_slow_instrument_sampled_fast_is_not_frozen():
    data = resting()
    for name, (time, values) in data.items():
        data[name] = (time, np.repeat(values[::10], 10))
    assert not {kind for kind, _ in kinds(recording(**data))} & {'frozen', 'constant', 'duplicate'}


def test_a_limit_is_found_at_the_values_that_reach_it():
    data = resting()
    time, values = data[f'{GYRO}.x']
    tone = 0.1 * np.sin(2.0 * np.pi * 0.5 * time) + values
    data[f'{GYRO}.x'] = (time, np.minimum(tone, 0.09))
    found = [f for f in run_checks(recording(**data)).findings if f.kind == 'clipped']
    assert [f.channel for f in found] == [f'{GYRO}.x']
    assert found[0].values == {'limit': 0.09, 'readings': float((tone >= 0.09).sum())}


def lit(counts, bits):
    """Return light blocks that reach so many counts, of a vehicle with so many bits or of none."""
    time = np.arange(10) * 0.1
    blocks = {'max': counts, 'min': counts - 10.0, 'mean': counts - 5.0, 'std': counts / 2.0}
    made = {f'photodiodes/{what}[0]': (time, np.full(10, v)) for what, v in blocks.items()}
    made |= {'light/peaks/amplitude[0]': (time, np.full(10, counts / 2.0))}
    told = {'vehicle_file': yaml.safe_dump(with_bits(bits))} if bits else {}
    return replace(recording(**made), provenance=told)


def with_bits(bits):
    """Return what a vehicle file holds whose converter has so many bits."""
    content = load_yaml(find_file('vehicle', 'gtmab'))
    content['sensors']['diodes']['bits'] = bits
    return content


@pytest.mark.parametrize('bits', [8, 12, 16])
def test_what_light_can_read_is_the_top_of_the_vehicles_converter(bits):
    top = 2.0**bits - 1.0
    assert not run_checks(lit(top - 1.0, bits)).findings
    (found,) = run_checks(lit(top, bits)).findings
    assert (found.kind, found.channel) == ('clipped', 'photodiodes/max[0]')
    assert found.values == {'limit': top, 'blocks': 10.0}
    beyond = {
        f.channel for f in run_checks(lit(top + 8.0, bits)).findings if f.kind == 'impossible'
    }
    assert beyond == {f'photodiodes/{what}[0]' for what in ('max', 'mean', 'std')}


@pytest.mark.parametrize('file', [None, 'name: of another version'])
def test_without_a_vehicle_nobody_knows_where_a_converter_ends(file):
    flight = lit(60000.0, None)
    flight = flight if file is None else replace(flight, provenance={'vehicle_file': file})
    report = run_checks(flight)
    assert report.findings == ()
    assert [text for text in report.unjudged if 'ADC' in text]
    assert {f.kind for f in run_checks(lit(-3.0, None)).findings} == {'impossible'}


def test_a_stretch_again_names_both():
    data = resting()
    time, values = data[f'{FORCE}.y']
    values[700:760] = values[100:160]
    (found,) = run_checks(recording(**data)).findings
    assert (found.kind, found.from_s) == ('duplicate', pytest.approx(time[700]))
    assert found.values == {'from_s': pytest.approx(time[100]), 'readings': 60.0}


@pytest.mark.parametrize(
    ('name', 'value', 'reason'),
    [
        ('range/range', -0.5, 'cannot be negative'),
        ('illuminance/illuminance', -1.0, 'cannot be negative'),
        ('battery/voltage', 4.7, 'is neither a cell'),
        ('motors/effort.left', 1.2, 'a duty is'),
        ('photodiodes/max[0]', -1.0, 'cannot be negative'),
        ('pressure/fluid_pressure', 2e5, 'air'),
    ],
)
def test_values_that_cannot_be_are_errors(name, value, reason):
    time = np.arange(200) * 0.1
    rng = np.random.default_rng(2)
    usual = {'battery/voltage': 3.9, 'pressure/fluid_pressure': 101325.0}.get(name, 0.5)
    values = usual + 0.01 * rng.normal(size=200)
    values[50:53] = value
    (found,) = run_checks(recording(**{name: (time, values)})).findings
    assert (found.kind, found.severity) == ('impossible', Severity.ERROR)
    assert (found.from_s, found.to_s) == pytest.approx((5.0, 5.2))
    assert reason in found.evidence


@pytest.mark.parametrize('voltage', [3.7, 7.4, 11.1, 22.2])
def test_packs_of_cells_are_possible(voltage):
    time = np.arange(100) * 0.1
    values = voltage - 0.001 * np.arange(100)
    assert run_checks(recording(**{'battery/voltage': (time, values)})).findings == ()


def test_gravity_tells_the_unit_and_the_sign_of_an_accelerometer():
    data = resting()
    in_g = {n: (t, v / 9.80665 if n.startswith(FORCE) else v) for n, (t, v) in data.items()}
    assert ('unit', FORCE) in kinds(recording(**in_g))
    time, values = data[f'{FORCE}.z']
    turned = data | {f'{FORCE}.z': (time, -values)}
    assert kinds(recording(**turned)) == {('axes', f'{FORCE}.z')}


def test_a_rest_that_does_not_feel_gravity_is_impossible():
    data = resting()
    time, values = data[f'{FORCE}.z']
    data[f'{FORCE}.z'] = (time, values + 1.5)
    assert kinds(recording(**data)) == {('impossible', FORCE)}


def test_smooth_data_is_a_warning_unless_it_says_that_it_is_simulated():
    time = np.arange(1000) * 0.01
    data = {f'{GYRO}.{a}': (time, 0.1 * np.sin(time + i)) for i, a in enumerate('xyz')}
    found = run_checks(recording(**data)).findings
    assert [(f.kind, f.severity, f.is_grave) for f in found] == [('filtered', 'warning', False)]
    declared = replace(recording(**data), provenance={'data': 'simulated'})
    assert run_checks(declared).findings == ()


def swinging(late=0.0, factor=1.0, sign=1.0):
    """Return a craft that yaws by 0.4 sin(w t) and swings, with a gyroscope beside its pose."""
    data = resting(count=2000)
    time = np.arange(2000) * 0.01
    rng = np.random.default_rng(8)
    tones = [0.4 * np.sin(2.1 * time) + 0.2 * np.sin(3.7 * time), 0.05 * np.sin(4.0 * time)]
    rates = [0.84 * np.cos(2.1 * (time - late)) + 0.74 * np.cos(3.7 * (time - late)),
             0.2 * np.cos(4.0 * (time - late))]  # fmt: skip
    yaw, pitch = (tone + rng.normal(0.0, 3e-4, 2000) for tone in tones)
    for part, values in (('yaw', yaw), ('pitch', pitch), ('roll', rng.normal(0.0, 3e-4, 2000))):
        data[f'ground_truth/odom/pose.pose.orientation.{part}'] = (time, values)
    # By hand, for turns about z, then y: wx = -yaw' sin(pitch), wy = pitch', wz = yaw' cos(pitch).
    tilt = 0.05 * np.sin(4.0 * (time - late))
    told = [-rates[0] * np.sin(tilt), rates[1], sign * rates[0] * np.cos(tilt)]
    for axis, values in zip('xyz', told, strict=True):
        data[f'{GYRO}.{axis}'] = (time, factor * (values + rng.normal(0.0, 1.4e-3, 2000)))
    return recording(**data)


def test_a_gyroscope_beside_its_attitude_is_clean():
    assert [f for f in run_checks(swinging()).findings if f.is_grave] == []


@pytest.mark.parametrize('late', [0.1, -0.25, 0.8])
def test_the_lag_of_a_gyroscope_is_told_with_its_error(late):
    found = [f for f in run_checks(swinging(late=late)).findings if f.kind == 'clock']
    assert [f.channel for f in found] == [GYRO]
    assert found[0].values['lag'] == pytest.approx(late, abs=0.01)
    assert found[0].values['error'] < 0.02


def test_degrees_and_a_turned_sign_of_a_gyroscope_are_told():
    (unit,) = [f for f in run_checks(swinging(factor=180.0 / np.pi)).findings if f.kind == 'unit']
    assert unit.channel == GYRO
    assert unit.values['factor'] == pytest.approx(57.3, rel=0.03)
    assert 'deg/s' in unit.evidence
    (turned,) = [f for f in run_checks(swinging(sign=-1.0)).findings if f.kind == 'axes']
    assert turned.channel == f'{GYRO}.z'
    assert 'z is recorded as -z' in turned.evidence


def test_a_clock_that_was_set_by_decades_is_named_and_fills_no_memory():
    """From 1970 to today, as of a computer without a battery for its clock."""
    data = {name: (one.time, one.values) for name, one in swinging().channels.items()}
    time = data[f'{GYRO}.x'][0]
    for axis in 'xyz':
        data[f'ground_truth/odom/pose.pose.position.{axis}'] = (time, 0.1 * np.sin(time))
    data = {n: (np.where(t > 10.0, t + 1.77e9, t), v) for n, (t, v) in data.items()}
    found = [f for f in run_checks(recording(**data)).findings if f.kind == 'stamps']
    assert found
    assert max(f.to_s - f.from_s for f in found) == pytest.approx(1.77e9, rel=1e-6)


def test_stamps_that_go_back_or_leave_out_are_found():
    data = resting()
    late = {n: (np.where(t > 5.0, t - 0.3, t), v) for n, (t, v) in data.items()}
    found = {f.evidence for f in run_checks(recording(**late)).findings if f.kind == 'stamps'}
    assert len(found) == 1
    assert 'go back by 0.290 s' in found.pop()
    hole = {n: (np.delete(t, range(300, 360)), np.delete(v, range(300, 360)))
            for n, (t, v) in data.items()}  # fmt: skip
    (gap,) = run_checks(recording(**hole)).findings
    assert (gap.from_s, gap.to_s) == pytest.approx((2.99, 3.6))


@pytest.mark.parametrize(('every', 'is_wrong'), [(40, False), (8, True)])
def test_a_few_messages_that_a_network_delivered_late_are_a_warning(every, is_wrong):
    order = np.arange(1000)
    # Each of them after the next one
    late = np.arange(100, 900, every)
    order[late], order[late + 1] = late + 1, late
    data = {n: (t[order], v[order]) for n, (t, v) in resting().items()}
    found = [f for f in run_checks(recording(**data)).findings if f.kind == 'stamps']
    assert (Severity.ERROR in {f.severity for f in found}) is is_wrong
    assert [f.values['late'] for f in found if 'late' in f.values][:1] == (
        [] if is_wrong else [len(late)]
    )


def test_log_times_that_part_from_stamps_are_found():
    flight = recording(**resting())
    arrived = np.arange(1000) * 0.01
    assert run_checks(replace(flight, arrivals={'imu': arrived + 3.0})).findings == ()
    arrived[500:] += 2.0
    (found,) = run_checks(replace(flight, arrivals={'imu': arrived})).findings
    assert found.values['jump'] == pytest.approx(-2.0)
