# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Comparisons of measured flights, with data by others that stay outside the project.

Looked for in `../shared/data` beside the project: RGBlimp (zhu-yj/ABNODE, MIT), motion capture at
60 Hz, four repeats of each input one after the other; and an outdoor flight of an aeroplane
(CogniPilot/cubs2, Apache-2.0), poses at 100 Hz with real clocks.
"""

import gzip
from pathlib import Path

from lta_data.bag import open_flight
from lta_data.bag.channels import iterate_channels
from lta_data.compare.channel_comparison import select_topic_pairs
from lta_data.compare.comparison import compare_sides, ComparisonRequest
from lta_data.flight import Channel
import numpy as np
import pytest

from .compare_flight import side_of

SHARED = Path(__file__).resolve().parents[5] / 'shared' / 'data'
BLIMP = SHARED / 'rgblimp'
OUTDOOR = SHARED / 'outdoor_mcap' / 'cub_stabilize_2025_11_13.mcap'
RATE = 60.0  # Hz
COLUMNS = {  # z down in the file, up here
    'tracker/pose.position.x': ('p_1', 'm', 1.0),
    'tracker/pose.position.y': ('p_2', 'm', -1.0),
    'tracker/pose.position.z': ('p_3', 'm', -1.0),
    'tracker/pose.orientation.yaw': ('e_3', 'rad', -1.0),
    'tracker/twist.linear.x': ('vb_1', 'm/s', 1.0),
    'motors/effort.left': ('Fl_series', 'N', 1.0),
}


def table(number):
    file = BLIMP / f'data_{number}.csv.gz'
    if not file.exists():
        pytest.skip(f'the measured blimp is not at {BLIMP}')
    with gzip.open(file, 'rt') as stream:
        names = stream.readline().strip().split(',')
        return dict(zip(names, np.loadtxt(stream, delimiter=',').T, strict=True))


def blimp(number, label):
    held = table(number)
    time = np.arange(len(held['p_1'])) / RATE
    return side_of(
        [
            Channel(name, unit, time, sign * held[column], unit == 'rad')
            for name, (column, unit, sign) in COLUMNS.items()
        ],
        label,
        frame='tracker',
    )


def compared(a, b, **asked):
    wanted = select_topic_pairs((), (), list(a.topics), list(b.topics))
    return compare_sides(a, b, wanted, ComparisonRequest(**asked))


def test_repeats_of_one_input_have_one_command_and_part_in_motion():
    found = compared(blimp(1, 'A'), blimp(2, 'B'))
    by_name = {each.name: each for each in found.channels}
    assert by_name['motors/effort.left'].measures.rms == 0.0
    altitude = by_name['tracker/pose.position.z']
    a, b = -table(1)['p_3'], -table(2)['p_3']
    size = min(len(a), len(b))
    rms = np.sqrt(np.mean((b[:size] - a[:size]) ** 2))
    assert altitude.measures.rms == pytest.approx(rms, rel=1e-9)
    assert altitude.measures.nrmse == pytest.approx(rms / np.std(a[:size]), rel=1e-9)
    assert altitude.parting.at is not None
    # Two runs, however alike, are not one run that was recorded twice.
    assert found.timing.how != 'clock'
    assert found.timing.estimated_offset is None or found.timing.estimated_offset.correlation < 0.9
    assert found.verdict == 'different'


def test_another_input_parts_in_the_command_too():
    found = compared(blimp(1, 'A'), blimp(21, 'B'))
    by_name = {each.name: each for each in found.channels}
    assert by_name['motors/effort.left'].verdict == 'parted'
    assert by_name['motors/effort.left'].parting.at == 0.0


def test_a_second_clock_on_a_real_flight_is_found():
    if not OUTDOOR.exists():
        pytest.skip(f'the outdoor flight is not at {OUTDOOR.parent}')
    flight = open_flight(OUTDOOR)
    own = [
        each for each in iterate_channels(flight, 'pose') if each.field != 'pose.orientation.roll'
    ]
    time = own[0].time
    chance = np.random.default_rng(0)
    begin, end = 30.0, 130.0
    at = np.sort(chance.uniform(begin, end, 3000))  # as uneven as a radio's
    b = []
    for each in own:
        known = np.interp(at, time, np.unwrap(each.values) if each.angular else each.values)
        noisy = known + 0.01 * chance.normal(size=len(at))
        b.append(Channel(each.name, each.unit, at + 0.1234, noisy, each.angular))
    part = (time > begin - 5.0) & (time < end + 5.0)
    a = [Channel(e.name, e.unit, e.time[part], e.values[part], e.angular) for e in own]
    found = compared(side_of(a, 'A', frame='map'), side_of(b, 'B', frame='map'))
    assert found.timing.how == 'clock'
    assert abs(found.timing.offset - 0.1234) < 4 * found.timing.sigma < 0.02
