# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Quick looks: which channels a word means, and what the terminal shows of them."""

import io
import re

from lta_analysis.plot import (
    build_channel_listing,
    build_report,
    crop_channel,
    draw_curves,
    group_by_unit,
    plot_channels,
    select_channels,
    unwrap_to_degrees,
)
from lta_config.errors import BadInput
from lta_data.bag import open_flight
from lta_data.flight import Channel
import numpy as np
import pytest
from rich.console import Console

from ...report_flight import write_flight  # noqa: TID252 - `test` is Python's own


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    return write_flight(tmp_path_factory.mktemp('plot') / 'bag', until=6.0)


def ramp(name='odom/z', unit='m', count=64, **more):
    values = np.arange(float(count))
    return Channel(name, unit, values / 10, values, **more)


@pytest.mark.parametrize(
    ('pattern', 'names'),
    [
        ('odom/pose.pose.position.z', ['odom/pose.pose.position.z']),
        ('light/peaks/snr[3]', ['light/peaks/snr[3]']),
        ('odom/*.yaw', ['odom/pose.pose.orientation.yaw']),
        ('*/pose.pose.position.y', ['ground_truth/odom/pose.pose.position.y'])
    ],
)  # fmt: skip
def test_a_word_means_channels(bag, pattern, names):
    found = [channel.name for channel in select_channels(open_flight(bag), [pattern])]
    assert set(names) <= set(found)
    assert {name.rpartition('.')[2] for name in found} == {names[0].rpartition('.')[2]}


def test_a_topic_means_all_of_its_channels(bag):
    names = [channel.name for channel in select_channels(open_flight(bag), ['motors', 'motors/*'])]
    rotors = ('up_left', 'up_right', 'forward_left', 'forward_right')
    assert names == [f'motors/effort.{rotor}' for rotor in rotors]


def test_a_word_that_means_nothing_or_too_much_is_one_sentence(bag):
    flight = open_flight(bag)
    with pytest.raises(BadInput, match=r"'odom/position\.z'; similar: .*odom/pose\.pose\.pos"):
        select_channels(flight, ['odom/position.z'])
    with pytest.raises(BadInput, match=r'^\d+ channels are too many for one plot'):
        select_channels(flight, ['*'])


def test_an_angle_is_shown_in_degrees_without_jumps():
    turned = Channel(
        'odom/yaw', 'rad', np.arange(4.0), np.array([3.0, np.nan, -3.0, 3.0]), angular=True
    )
    shown = unwrap_to_degrees(turned)
    assert shown.unit == 'deg'
    expected = np.degrees([3.0, np.nan, 2 * np.pi - 3.0, 3.0])
    np.testing.assert_allclose(shown.values, expected, atol=1e-9)
    plain = ramp()
    assert unwrap_to_degrees(plain) is plain


def test_a_stretch_of_time_is_closed():
    part = crop_channel(ramp(), 1.0, 2.0)
    assert part.values.tolist() == list(range(10, 21))


def test_what_has_one_unit_shares_an_axis():
    shown = [ramp('a/z'), ramp('b/speed', 'm/s'), ramp('c/x')]
    found = {unit: [channel.name for channel in inside] for unit, inside in group_by_unit(shown)}
    assert found == {'m': ['a/z', 'c/x'], 'm/s': ['b/speed']}


def split_plot(text):
    """Return what is inside the frame of a plot, and what is below it."""
    lines = text.splitlines()
    bottom = next(k for k, line in enumerate(lines) if '└' in line)
    return [re.split('[│┤]', line)[1] for line in lines[1:bottom]], lines[bottom + 1 :]


def list_filled_columns(rows):
    return [[k for k, letter in enumerate(row) if letter != ' '] for row in rows]


def test_values_that_are_unknown_or_out_of_all_bounds_are_gaps():
    """plotext ends the process at a NaN in a line."""
    time = np.arange(8.0)
    values = np.array([0.0, 1.0, np.nan, np.nan, np.inf, -1e300, 1.0, 0.0])
    rows, _ = split_plot(draw_curves('', [Channel('z', '', time, values)], (0.0, 7.0), 80).plain)
    columns = sorted(set().union(*list_filled_columns(rows)))
    # Dots in the first and the last seventh, none in the five between them
    assert max(np.diff(columns)) > 0.65 * len(rows[0])


def test_a_picture_holds_the_values():
    figure = plot_channels('m', [ramp('a/z'), ramp('b/z')], (0.0, 6.3))
    assert [trace.name for trace in figure.data] == ['a/z', 'b/z']
    np.testing.assert_allclose(figure.data[0].y, np.arange(64.0))
    assert figure.layout.yaxis.title.text == '[m]'


def test_the_report_has_a_figure_for_each_unit_and_tiles():
    panels = [('m', [ramp('a/z'), ramp('b/z')]), ('m/s', [ramp('a/speed', 'm/s')])]
    report = build_report('a, b', panels, (0.0, 6.3), {})
    (stack,) = report.blocks
    assert [each.heading for each in stack.blocks] == ['a, b', 'a']
    assert report.subject == '3 channels, 0.0 to 6.3 s'
    assert report.tiles[2] == ('a/speed', '31.5', 'm/s', 'mean; 0 to 63')


def test_the_command_lists_all_and_draws_some(call, bag, tmp_path):
    status, said = call('bag', 'plot', bag)
    assert status == 0
    assert 'ground_truth/odom/pose.pose.position.z' in said.out
    assert 'wind/vector.x' in said.out
    status, said = call('bag', 'plot', bag, 'odom/pose.pose.position.z', '--from', '2')
    assert status == 0
    assert '━━ odom/pose.pose.position.z' in said.out
    page = tmp_path / 'look.html'
    status, said = call('bag', 'plot', bag, 'motors', '--html', page)
    assert (status, said.out) == (0, f'Page {page}\n')
    assert 'figure-unit-0' in page.read_text()


def test_names_stay_whole_where_the_terminal_is_narrow():
    t = np.arange(100) / 10.0
    name = 'ground_truth/odom/pose.pose.position.x'
    console = Console(width=80, file=io.StringIO())
    console.print(build_channel_listing([Channel(name, 'm/s2', t, -np.sqrt(t))], console.width))
    assert name in console.file.getvalue()
