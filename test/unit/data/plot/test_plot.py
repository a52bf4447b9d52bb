"""Quick looks: which channels a word means, and what the terminal shows of them."""

import io
from itertools import pairwise

from lta_config.errors import BadInput
from lta_data.bag import open_flight
from lta_data.bag.channels import SignalChannel
from lta_data.plot.channel_selection import (
    crop_channel,
    group_by_unit,
    select_channels,
    unwrap_to_degrees,
)
from lta_data.plot.report import build_report, plot_channels
from lta_data.plot.terminal import build_channel_listing, draw_curves, draw_sparkline
import numpy as np
import pytest
from rich.console import Console

from ...report_flight import write_flight  # noqa: TID252 - `test` is Python's own


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    return write_flight(tmp_path_factory.mktemp('plot') / 'bag', until=6.0)


def ramp(name='odom/z', unit='m', count=64, **more):
    values = np.arange(float(count))
    return SignalChannel(name, unit, values / 10, values, **more)


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
    turned = SignalChannel(
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


def test_a_line_of_blocks_follows_the_means():
    assert draw_sparkline(np.arange(8.0), 8) == '▁▂▃▄▅▆▇█'
    assert draw_sparkline(np.array([0.0, 0.0, np.nan, np.nan, 1.0, 1.0]), 3) == '▁ █'
    assert draw_sparkline(np.full(5, 2.0)) == 'constant'
    assert draw_sparkline(np.full(5, np.nan)) == 'no value'


def test_a_curve_rises_from_the_lower_left_to_the_upper_right():
    rows = draw_curves('m', [ramp()], (0.0, 6.3), 40).plain.splitlines()
    assert rows[0].split()[0] == '63'
    canvas = [row.split('│')[1] for row in rows if '│' in row]
    filled = [[k for k, letter in enumerate(row) if letter != ' '] for row in canvas]
    assert filled[0][-1] == 27  # 40 characters, 12 of them margin
    assert filled[-1][0] == 0
    middles = [np.mean(columns) for columns in filled]
    assert all(upper > lower for upper, lower in pairwise(middles))
    assert rows[-1].strip() == '━━ odom/z'
    assert '0 s' in rows[-2]
    assert '6.3 s' in rows[-2]


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


@pytest.mark.parametrize(
    ('words', 'sentence'),
    [
        (('none',), "No channel matches 'none'"),
        (('motors', '--from', '5', '--to', '4'), '--from (5 s) must be less than --to (4 s)'),
        (('motors', '--from', '99'), 'have no data between --from and --to'),
    ],
)
def test_what_cannot_be_shown_is_one_sentence(call, bag, words, sentence):
    status, said = call('bag', 'plot', bag, *words)
    assert status == 2
    assert sentence in said.err
    assert said.err.count('\n') == 1


def test_names_stay_whole_where_the_terminal_is_narrow():
    t = np.arange(100) / 10.0
    name = 'ground_truth/odom/pose.pose.position.x'
    console = Console(width=80, file=io.StringIO())
    console.print(
        build_channel_listing([SignalChannel(name, 'm/s2', t, -np.sqrt(t))], console.width)
    )
    assert name in console.file.getvalue()
