# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Flights without a common clock: separate runs, and texts that count from their own start."""

from pathlib import Path

from lta_data.bag import open_flight
from lta_data.compare.channel_comparison import select_topic_pairs
from lta_data.compare.comparison import compare_flights, compare_sides, ComparisonRequest
from lta_data.flight import Channel
from lta_data.importers.run import import_logs, ImportRequest
import numpy as np
import pytest

from .compare_flight import motion, side_of, UNIX
from .compare_two import channel


def run_of(start, seed, label, clock):
    """Return a flight that rests until its command, then wanders as its air has it."""
    t = np.arange(0.0, 30.0, 0.01)
    since = np.maximum(t - start, 0.0)
    chance = np.random.default_rng(seed)
    climb = 0.3 * np.minimum(since, 1.0) + 0.4 * np.sin(since * 2.0 + seed) * (since > 0.0)
    noise = 0.003 * chance.normal(size=(2, len(t)))
    speed = since**0.5 * np.cos(seed * t) + noise[1]
    return side_of(
        [
            Channel('motors/effort.left', '1', t, np.where(t >= start, 0.4 + 0.05 * seed, 0.0)),
            Channel('odom/pose.pose.position.z', 'm', t, climb + noise[0]),
            Channel('odom/twist.twist.linear.x', 'm/s', t, speed),
        ],
        label,
        clock,
    )


def test_separate_runs_are_laid_on_each_other_by_their_commands():
    a, b = run_of(4.0, 1, 'A', 0), run_of(5.5, 2, 'B', UNIX)
    wanted = select_topic_pairs((), (), list(a.topics), list(b.topics))
    found = compare_sides(a, b, wanted, ComparisonRequest())
    assert (found.timing.how, found.timing.on_stamps) == ('motion', False)
    assert found.timing.offset == pytest.approx(1.5, abs=0.011)
    assert 'separate runs' in found.timing.reason
    assert found.span == pytest.approx((0.0, 28.49), abs=0.02)
    duty = channel(found, 'motors/effort.left')
    assert duty.parting.at == pytest.approx(4.0, abs=0.02)
    assert duty.measures.greatest == pytest.approx(0.05)
    alone = compare_sides(a, b, wanted, ComparisonRequest(align='none'))
    assert (alone.timing.how, alone.timing.offset) == ('none', 0.0)


def imported_csv(tmp_path, name, until, phase, time='time: {rate: 50 Hz}'):
    """Import hand-made motion as a text, whose first row is `phase` into the motion."""
    t = phase + np.arange(round(50 * until)) / 50.0
    chance = np.random.default_rng(len(name))
    rows = np.column_stack([t - phase, motion(t)[:, :3] + 0.001 * chance.normal(size=(len(t), 3))])
    source, mapping = tmp_path / f'{name}.csv', tmp_path / 'm.yaml'
    np.savetxt(source, rows, delimiter=',', header='t,x,y,z', comments='', fmt='%.9f')
    mapping.write_text(
        f'schema: 1\nname: m\nabout: a\nformat: csv\n{time}\n'
        'topics:\n  - {topic: odom, position: {columns: [x, y, z], unit: m}}\n'
    )
    (done,) = import_logs(ImportRequest([source], str(mapping)), tmp_path / name)
    return open_flight(Path(done.bag))


@pytest.mark.parametrize('time', ['time: {rate: 50 Hz}', 'time: {column: t}'])
def test_rows_that_are_counted_alike_are_no_common_clock(tmp_path, time):
    # One motion; the second text begins 0.4 s later in it, and both count from zero.
    a = imported_csv(tmp_path, 'one', 40.0, 0.0, time)
    b = imported_csv(tmp_path, 'other', 38.0, 0.4, time)
    found = compare_flights(a, b, ComparisonRequest())
    assert found.timing.how == 'clock'
    assert found.timing.offset == pytest.approx(-0.4, abs=max(0.005, 4 * found.timing.sigma))
    assert found.verdict == 'same'
    # One text imported twice is one clock.
    assert compare_flights(a, a, ComparisonRequest()).timing.reason.startswith(
        'Both flights have the same time stamps'
    )
    assert compare_flights(a, b, ComparisonRequest(align='none')).timing.offset == 0.0
