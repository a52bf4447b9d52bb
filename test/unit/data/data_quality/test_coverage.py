# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A recording is clean only if something was judged, and the answer says what."""

from lta_data.data_quality.registry import run_checks
from lta_data.flight import Channel, Flight
import numpy as np
import pytest

from .test_rereadings import record, TOPIC


def make(topic, fields, values, time=None):
    """Return channels of a topic, with the same values in each."""
    time = np.arange(len(values)) * 0.02 if time is None else time
    names = [f'{topic}/{field}' for field in fields]
    return {name: Channel(name, '1', time, np.array(values, dtype=float)) for name in names}


def test_what_was_judged_is_listed():
    report = run_checks(record())
    assert report.status == 'clean'
    (sentence,) = report.judged
    assert all(word in sentence for word in ('position', 'attitude', 'velocity', 'rates', TOPIC))


@pytest.mark.parametrize('channels', [
    {},
    make('/x', ['data'], np.sin(np.arange(300.0))),
    make('ground_truth/odom', ['pose.pose.position.x'], [1.0] * 10),
])  # fmt: skip
def test_where_nothing_can_be_judged_it_is_not_checked(channels):
    report = run_checks(Flight(channels))
    assert (report.findings, report.status, report.judged) == ((), 'not checked', ())


@pytest.mark.parametrize(('part', 'word'), [
    ('pose.pose.orientation', 'attitude'), ('pose.pose.position', 'position'),
])  # fmt: skip
def test_what_was_never_measured_is_named(part, word):
    channels = dict(record().channels)
    for name, channel in channels.items():
        if part in name:
            missing = np.full(len(channel.time), np.nan)
            channels[name] = Channel(name, '', channel.time, missing)
    report = run_checks(Flight(channels, {'data': 'measured'}))
    assert f'The {word} was never measured' in ' '.join(one.evidence for one in report.findings)
    assert report.status == 'findings'
    assert word not in report.judged[0]


def test_a_gap_on_irregular_stamps_is_found_and_losses_are_not_counted():
    rng = np.random.default_rng(4)
    time = np.cumsum(rng.uniform(0.005, 0.06, 2000))
    time[1200:] += 4.0
    channels = make('range', ['range'], 1.0 + 0.01 * rng.standard_normal(2000), time)
    report = run_checks(Flight(channels))
    (gap,) = [one for one in report.findings if one.kind == 'stamps']
    assert gap.values['gap'] == pytest.approx(4.0, abs=0.1)
    assert any('irregular' in sentence for sentence in report.unjudged)


def burst(rng, sent):
    return np.where(rng.random(len(sent)) < 0.03, rng.uniform(0.0, 0.08, len(sent)), 0.0)


@pytest.mark.parametrize(('rate', 'delays'), [
    (50.0, lambda rng, sent: rng.exponential(0.006, len(sent))),
    (200.0, lambda rng, sent: rng.exponential(0.006, len(sent))),
    (50.0, lambda rng, sent: rng.uniform(0.0, 0.015, len(sent))),
    (100.0, lambda rng, sent: np.abs(rng.normal(0.0, 0.006, len(sent)))),
    (100.0, burst),  # a network that halts now and then
    (100.0, lambda rng, sent: -sent % 0.04),  # four at once
])  # fmt: skip
def test_stamps_of_arrivals_that_are_late_break_no_rule(rate, delays):
    rng = np.random.default_rng(5)
    recording = record()
    count = len(next(iter(recording.channels.values())).time)
    sent = np.arange(count) / rate
    time = np.maximum.accumulate(sent + delays(rng, sent)) + np.arange(count) * 1e-6
    # The same poses in less time
    quicker = {name: rate / 50.0 if 'twist' in name else 1.0 for name in recording.channels}
    channels = {
        name: Channel(name, one.unit, time, one.values * quicker[name])
        for name, one in recording.channels.items()
    }
    assert run_checks(Flight(channels, {'data': 'measured'})).findings == ()


@pytest.mark.parametrize('digits', [2, 3])
def test_rounded_readings_of_a_slow_motion_break_no_rule(digits):
    channels = {
        name: Channel(name, one.unit, one.time, np.round(one.values, digits))
        for name, one in record().channels.items()
    }
    report = run_checks(Flight(channels, {'data': 'measured'}))
    assert not report.is_grave
    assert any('is rounded (x to 0.0' in sentence for sentence in report.unjudged)


def test_a_rounded_reading_that_freezes_and_jumps_is_found():
    time = np.arange(3000) * 0.02
    place = np.round(1.5 * np.sin(0.4 * time), 2)
    place[1500:1550] = place[1500]
    channels = make('ground_truth/odom', ['pose.pose.position.x'], place, time)
    (finding,) = run_checks(Flight(channels, {'data': 'measured'})).findings
    assert (finding.kind, finding.from_s) == ('frozen', pytest.approx(30.0, abs=0.1))


def test_notes_alone_are_no_check():
    channels = {
        name: Channel(name, '', one.time, np.full(len(one.time), np.nan))
        for name, one in record().channels.items()
        if 'twist' not in name
    }
    report = run_checks(Flight(channels, {'data': 'measured'}))
    assert report.findings
    assert (report.status, report.judged) == ('not checked', ())


def test_what_is_too_short_or_not_there_is_said():
    short = {
        name: Channel(name, '', one.time[:200], one.values[:200])
        for name, one in record().channels.items()
        if 'position' in name
    }
    said = ' '.join(run_checks(Flight(short, {'data': 'measured'})).unjudged)
    assert 'too short to compare motions' in said
    assert 'It has no attitude' in said
    assert 'no message' in run_checks(Flight({})).unjudged[0]
