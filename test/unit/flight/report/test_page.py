# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The page of a flight: whole, self-contained, and honest about what is missing."""

import base64
from html.parser import HTMLParser
import json
import re
import zlib

from lta_config.command_line import relative_path
from lta_data.bag import open_flight
from lta_flight.report import write_page
from lta_flight.report.page import format_repeat_command, suggest_commands
from lta_flight.report.panels import FLIGHT_PANELS
from lta_flight.report.scene import build_track
from lta_flight.report.view import FlightView
from lta_report import html_elements
import numpy as np
from plotly.graph_objects import Figure
import pytest

from ...report_flight import STREAMS, write_flight  # noqa: TID252 - `test` is Python's own

VOID = {'meta', 'link', 'img', 'input', 'br', 'hr', 'base', 'source'}
BASIC = {'odom', 'motors', 'light/bearing'}  # topics without which a page is tried every time
FETCHING = {'src', 'href', 'srcset', 'data', 'poster', 'action'}


class Reading(HTMLParser):
    """A page as a browser without a network sees it."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.addresses, self.data, self.text = [], [], [], {}, ''
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.ids += [found['id']] if 'id' in found else []
        self.addresses += [value for key, value in attrs if key in FETCHING]
        if tag not in VOID:
            self.open.append((tag, found))

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        tag, attributes = self.open[-1] if self.open else ('', {})
        if tag == 'script' and attributes.get('type') == 'application/json':
            if size := int(attributes.get('data-size', 0)):
                data = zlib.decompress(base64.b85decode(data)[:size])
            self.data[attributes['id']] = json.loads(data)
        elif tag not in ('script', 'style'):
            self.text += data


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    return write_flight(tmp_path_factory.mktemp('flight') / 'bag')


@pytest.fixture(scope='module')
def written(bag):
    out = bag.parent / 'page.html'
    write_page(bag, out)
    return out


@pytest.fixture(scope='module')
def reading(written):
    return Reading(written.read_text(encoding='utf-8'))


def test_page_is_well_formed_and_every_id_is_unique(reading):
    assert reading.open == []
    assert len(reading.ids) == len(set(reading.ids))


def test_page_has_every_panel_with_figure_and_caption(reading):
    for panel in FLIGHT_PANELS:
        assert f'panel-{panel.name}' in reading.ids
        figure = reading.data[f'figure-{panel.name}']
        Figure(figure)  # plotly itself finds it valid
        assert panel.title in reading.text
        assert panel.caption in reading.text


def test_page_fetches_nothing(written, reading):
    assert [address for address in reading.addresses if not address.startswith('#')] == []
    text = written.read_text(encoding='utf-8')
    styles = re.findall(r'<style>(.*?)</style>', text, re.DOTALL)
    assert styles
    assert not [style for style in styles if '@import' in style or 'url(' in style]


def test_page_shows_commands_that_can_be_copied(tmp_path, monkeypatch):
    view = FlightView(open_flight(write_flight(tmp_path / 'my runs' / 'bag', until=6.0)))
    monkeypatch.setenv('LTA_CALLED', './lta')
    monkeypatch.chdir(tmp_path)
    lines = suggest_commands(view, relative_path(tmp_path / 'my runs' / 'bag'))
    assert lines['List what was recorded'] == "./lta bag info 'my runs/bag'"
    assert re.fullmatch(r"plotjuggler -d 'my runs/bag/\w+\.mcap'", lines['Plot any topic'])
    assert lines['Replay in ROS 2'].startswith("ros2 bag play 'my runs/bag'")
    clocked = lines['Replay in ROS 2'].endswith(' --clock')
    assert clocked is ('/clock' not in view.flight.bag.topics)
    assert lines['Fly it again'].startswith('./lta fly --vehicle gtmab ')


def test_every_axis_has_a_title_with_unit(reading):
    for panel in FLIGHT_PANELS:
        layout = reading.data[f'figure-{panel.name}']['layout']
        axes = {key: axis for key, axis in layout.items() if re.match('[xy]axis', key)}
        titles = [axis['title']['text'] for axis in axes.values() if 'title' in axis]
        assert titles, panel.name
        for title in titles:
            assert re.search(r'\[.+\]$', title), (panel.name, title)
        for side in 'xy':
            assert any(key[0] == side and 'title' in axis for key, axis in axes.items())


def test_page_of_the_same_bag_is_the_same(bag, written, tmp_path):
    again = bag.parent / 'again.html'
    write_page(bag, again)
    assert again.read_bytes() == written.read_bytes()


@pytest.mark.parametrize(
    'missing',
    [
        pytest.param(name, marks=() if name in BASIC else pytest.mark.long)
        for name in sorted(STREAMS)
    ],
)
def test_page_does_without_any_one_topic(tmp_path, missing):
    write_page(write_flight(tmp_path / 'bag', without=[missing], until=6.0), tmp_path / 'p.html')
    reading = Reading((tmp_path / 'p.html').read_text(encoding='utf-8'))
    lost = {panel.name for panel in FLIGHT_PANELS if missing in panel.needs}
    assert {
        panel.name for panel in FLIGHT_PANELS if f'figure-{panel.name}' not in reading.data
    } == lost
    assert reading.text.count(f'The recording has nothing on {missing}.') == len(lost)


def test_page_of_a_bag_without_anything_we_know(tmp_path):
    folder = write_flight(tmp_path / 'bag', without=list(STREAMS), facts={})
    results = write_page(folder, tmp_path / 'p.html')
    reading = Reading((tmp_path / 'p.html').read_text(encoding='utf-8'))
    assert results.success is None
    assert reading.text.count('The recording has nothing on') == len(FLIGHT_PANELS)


def test_page_without_scenario_draws_the_path_alone(tmp_path):
    write_page(write_flight(tmp_path / 'bag', until=6.0, facts={}), tmp_path / 'p.html')
    reading = Reading((tmp_path / 'p.html').read_text(encoding='utf-8'))
    assert set(reading.data) >= {f'figure-{panel.name}' for panel in FLIGHT_PANELS}
    assert 'The recording has no scenario.' in reading.text


def test_data_for_the_script_cannot_end_their_element():
    text = html_elements.embed_data('x', {'a': '</script><!-- b'})
    assert text.count('</script') == 1
    assert '<!--' not in text
    assert Reading(text).data == {'x': {'a': '</script><!-- b'}}


def test_replay_is_the_flight_at_even_instants(bag):
    track = build_track(FlightView(open_flight(bag)))
    length = len(track['time'])
    assert all(len(track[name]) == length for name in track.keys() - {'start', 'radius'})
    time = np.array(track['time'])
    np.testing.assert_allclose(np.diff(time), 17.0 / (length - 1), atol=2e-3)
    expected = -3.5 + 0.5 * np.clip(time - 4.0, 0.0, 12.0)
    np.testing.assert_allclose(track['x'], expected, atol=2e-3)
    assert track['radius'] == [0.5]
    gated = (time > 10.06) & (time < 12.04)
    assert all(track['bearing'][k] is None for k in np.flatnonzero(gated))


def test_a_moved_start_is_flown_again_by_the_launch_file():
    given = {'vehicle': 'gtmab', 'seed': '2', 'time': 'lockstep', 'commit': 'abc'}
    assert format_repeat_command(given).endswith('fly --vehicle gtmab --seed 2 --time lockstep')
    moved = format_repeat_command({**given, 'offset_y': '-2.0'})
    assert moved.endswith('launch fly vehicle:=gtmab seed:=2 time:=lockstep offset_y:=-2.0')
