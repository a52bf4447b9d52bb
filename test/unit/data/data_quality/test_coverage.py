"""A recording is clean only if something was judged, and the answer says what."""

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality.recording import ChannelRecording
from lta_data.data_quality.registry import run_checks
import numpy as np
import pytest

from .test_rereadings import record, TOPIC


def make(topic, fields, values, time=None):
    """Return channels of a topic, with the same values in each."""
    time = np.arange(len(values)) * 0.02 if time is None else time
    names = [f'{topic}/{field}' for field in fields]
    return {name: SignalChannel(name, '1', time, np.array(values, dtype=float)) for name in names}


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
    report = run_checks(ChannelRecording(channels))
    assert (report.findings, report.status, report.judged) == ((), 'not checked', ())


@pytest.mark.parametrize(('part', 'word'), [
    ('pose.pose.orientation', 'attitude'), ('pose.pose.position', 'position'),
])  # fmt: skip
def test_what_was_never_measured_is_named(part, word):
    channels = dict(record().channels)
    for name, channel in channels.items():
        if part in name:
            missing = np.full(len(channel.time), np.nan)
            channels[name] = SignalChannel(name, '', channel.time, missing)
    report = run_checks(ChannelRecording(channels, {'data': 'measured'}))
    assert f'The {word} was never measured' in ' '.join(one.evidence for one in report.findings)
    assert report.status == 'findings'
    assert word not in report.judged[0]


def test_a_gap_on_irregular_stamps_is_found_and_losses_are_not_counted():
    rng = np.random.default_rng(4)
    time = np.cumsum(rng.uniform(0.005, 0.06, 2000))
    time[1200:] += 4.0
    channels = make('range', ['range'], 1.0 + 0.01 * rng.standard_normal(2000), time)
    report = run_checks(ChannelRecording(channels))
    (gap,) = [one for one in report.findings if one.kind == 'stamps']
    assert gap.values['gap'] == pytest.approx(4.0, abs=0.1)
    assert any('irregular' in sentence for sentence in report.unjudged)


@pytest.mark.parametrize(('rate', 'late'), [(50.0, 0.006), (100.0, 0.004), (200.0, 0.002)])
def test_stamps_of_arrivals_that_are_late_break_no_rule(rate, late):
    rng = np.random.default_rng(5)
    recording = record()
    count = len(next(iter(recording.channels.values())).time)
    sent = np.arange(count) / rate
    time = np.maximum.accumulate(sent + rng.exponential(late, count)) + np.arange(count) * 1e-6
    # The same poses in less time
    quicker = {name: rate / 50.0 if 'twist' in name else 1.0 for name in recording.channels}
    channels = {
        name: SignalChannel(name, one.unit, time, one.values * quicker[name])
        for name, one in recording.channels.items()
    }
    assert run_checks(ChannelRecording(channels, {'data': 'measured'})).findings == ()
