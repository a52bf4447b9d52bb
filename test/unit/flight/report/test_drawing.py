# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Lines, labels and colours of the pictures."""

import re

from lta_data.bag import open_flight
from lta_flight.report import light_panels
from lta_flight.report.light_panels import select_sample_blocks
from lta_flight.report.panels import create_time_figure, FLIGHT_PANELS
from lta_flight.report.path import (
    BRIGHTEST,
    build_light_contour,
    draw_room,
    select_per_period,
)
from lta_flight.report.view import FlightView, select_primary_beacon
from lta_model.scenario import load_scenario
from lta_report import palette
from lta_report.drawing import decimate_line, EndLabel, label_ends, MOST_POINTS
from lta_vlc.spectral.spectrum import amplitude_spectrum
import numpy as np
from plotly.graph_objects import Figure
import pytest

from ...report_flight import write_flight  # noqa: TID252 - `test` is Python's own

COLOUR = re.compile(r'#[0-9a-f]{6}\b|rgba?\([^)]*\)')
WORDS = ['INK', 'SOFT', 'TRUTH', 'ESTIMATE', 'SETPOINT', 'LAMP', 'GOOD']


@pytest.fixture(scope='module')
def view(tmp_path_factory):
    return FlightView(open_flight(write_flight(tmp_path_factory.mktemp('flight') / 'bag')))


def luminance(colour):
    """Return the relative luminance of #rrggbb (WCAG 2.1)."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    light, dark = sorted([luminance(one), luminance(other)], reverse=True)
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize('name', WORDS)
def test_words_can_be_read_on_both_papers(name):
    colour = getattr(palette, name)
    assert contrast(colour, palette.PAPER) >= 4.5
    assert contrast(palette.DARK[colour], palette.DARK[palette.PAPER]) >= 4.5


@pytest.mark.parametrize('panel', FLIGHT_PANELS, ids=lambda panel: panel.name)
def test_every_colour_has_its_partner_on_dark_paper(view, panel):
    drawn = panel.picture(view)
    drawn.layout.template.data = {}
    used = set(COLOUR.findall(drawn.to_json()))
    assert used - set(palette.DARK) == set()


@pytest.mark.parametrize('scale', ['TIME', 'HEAT'])
@pytest.mark.parametrize('dark', [False, True])
def test_scales_are_ordered_by_lightness(scale, dark):
    colours = getattr(palette, scale)
    shades = [luminance(palette.DARK[colour] if dark else colour) for colour in colours]
    assert shades in (sorted(shades), sorted(shades, reverse=True))


@pytest.mark.parametrize('panel', FLIGHT_PANELS, ids=lambda panel: panel.name)
def test_no_line_has_more_points_than_anyone_can_see(view, panel):
    for trace in panel.picture(view).data:
        assert trace.x is None or len(trace.x) <= MOST_POINTS + 2


def test_thinning_keeps_the_ends_and_every_spike():
    time = np.linspace(0.0, 60.0, 6001)
    values = np.sin(time)
    values[[17, 4321]] = 9.0, -9.0
    x, y = decimate_line(time, values)
    assert len(x) <= MOST_POINTS + 1
    assert np.all(np.diff(x) > 0.0)
    assert (y.max(), y.min()) == (9.0, -9.0)
    assert x[0] == 0.0
    assert x[-1] == pytest.approx(60.0, abs=0.07)


def test_labels_at_the_same_height_are_moved_apart_and_stay_inside(view):
    figure = create_time_figure(view)
    before = len(figure.layout.annotations)
    label_ends(figure, [EndLabel(name, 1.0, '#000000') for name in 'abcd'], (0.0, 1.0))
    heights = sorted(note.y for note in figure.layout.annotations[before:])
    assert np.all(np.diff(heights) >= 0.0849)
    assert heights[-1] <= 1.0


def test_moments_are_the_ends_of_the_search(view):
    far, near = select_sample_blocks(view)
    assert far.where == '7.0 m from the lamp'
    assert near.where in {'1.0 m from the lamp', '1.1 m from the lamp'}  # 1.05 m
    for moment, distance in ((far, 7.0), (near, 1.05)):
        spectrum = amplitude_spectrum(moment.samples[:, None])[:, 0]
        assert spectrum[15] == pytest.approx(500.0 / distance**2, rel=0.05)  # 150 Hz, 10 Hz a bin
        assert spectrum[10] == pytest.approx(20.0, rel=0.05)  # the mains


def test_a_map_of_a_long_flight_has_no_more_columns_than_a_screen():
    short, long = np.arange(12.0).reshape(2, 6), np.arange(2.0 * 2501).reshape(2, 2501)
    np.testing.assert_array_equal(light_panels.average_stretches(short), short)
    found = light_panels.average_stretches(long)
    assert found.shape == (2, 834)
    np.testing.assert_array_equal(found[0, :2], [1.0, 4.0])
    np.testing.assert_array_equal(found[:, -1], [2499.5, 5000.5])


def test_the_floor_is_lit_by_every_lamp():
    patrol = load_scenario('warehouse_patrol')
    drawn = build_light_contour(patrol, 0.5)
    places = [lamp.position.vector[:2] for lamp in patrol.lamps.values()]
    at = [drawn.z[np.abs(drawn.y - y).argmin(), np.abs(drawn.x - x).argmin()] for x, y in places]
    assert min(at) > BRIGHTEST  # half a metre above 10,000 lm
    assert drawn.z[0, 0] < BRIGHTEST  # a corner


def test_every_lamp_is_drawn_and_every_goal_has_its_circle():
    patrol = load_scenario('warehouse_patrol')
    figure = Figure()
    draw_room(figure, patrol, 0.5)
    names = [trace.name for trace in figure.data]
    assert names == ['light of the lamps', 'dock', 'aisle', 'gate', 'start']
    circles = [shape for shape in figure.layout.shapes if shape.type == 'circle']
    middles = [((c.x0 + c.x1) / 2, (c.y0 + c.y1) / 2) for c in circles]
    assert middles == [pytest.approx((3.5, -2.0)), pytest.approx((0.0, 4.0))]


def test_single_blocks_are_those_of_the_whole_topic(view):
    every = view.flight.read_blocks('photodiodes')
    last = len(every.time) - 1
    np.testing.assert_array_equal(view.read_blocks((last, 0, 0)), every.samples[[last, 0, 0]])
    assert view.flight.read_blocks('photodiodes', [last]).time.tolist() == [every.time[-1]]


def test_of_two_beacons_the_wanted_one_is_drawn():
    """Two diodes; the second block has a second beacon behind the first, which is stronger."""
    none = np.nan
    fields = {
        'x': np.array([[1.0, -1.0, none, none], [1.0, -1.0, 1.0, -1.0]]),
        'y': np.array([[0.0, 0.0, none, none], [0.0, 0.0, 0.0, 0.0]]),
        'z': np.array([[0.0, 0.0, none, none], [0.0, 0.0, 0.0, 0.0]]),
        'snr': np.array([[5.0, 2.0, none, none], [7.0, 3.0, 90.0, 80.0]]),
    }
    assert select_primary_beacon(fields)['snr'].tolist() == [[5.0, 2.0], [7.0, 3.0]]
    one = {name: values[:1, :2] for name, values in fields.items()}
    assert select_primary_beacon(one)['snr'].tolist() == [[5.0, 2.0]]


def test_there_is_a_ray_a_second_where_something_was_seen_however_long_it_was_not():
    time = np.array([0.5, 1.0, 1.2, 2.1, 4.9, 5.0, 1.77e9, 1.77e9 + 0.5, 1.77e9 + 2.0])
    assert select_per_period(time, 1.0, 1.77e9 + 1.0).tolist() == [1, 3, 4, 5, 6]
    assert select_per_period(time, 6.0, 7.0).tolist() == []
