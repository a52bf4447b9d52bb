# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A recording as a dataset of xarray and as a plot of matplotlib."""

import sys

import lta_analysis
from lta_config.errors import BadInput
from lta_data.bag.flight_views import build_dataset
from lta_data.bag.table import STAMP_COLUMN
import numpy as np
import pandas
import pytest

pyplot = pytest.importorskip('matplotlib.pyplot')
xarray = pytest.importorskip('xarray')


@pytest.fixture
def flight(flight_bag):
    """Return the flight of 40 steps, without a window for its plots."""
    pyplot.switch_backend('agg')
    yield lta_analysis.open(flight_bag)
    pyplot.close('all')


def test_a_dataset_has_the_rows_units_and_frames_of_its_topics(flight, tmp_path):
    data = flight.to_xarray('odom', 'energy/reserve')
    np.testing.assert_allclose(data.time, 0.01 * np.arange(40), rtol=0, atol=1e-12)
    x, speed = data['odom.pose.pose.position.x'], data['odom.twist.twist.linear.x']
    np.testing.assert_array_equal(x, 0.1 * np.arange(40))
    assert x.attrs == {'units': 'm', 'frame': 'map'}
    assert speed.attrs == {'units': 'm/s', 'frame': 'base_link'}
    assert data['energy.reserve.data'].attrs == {}
    assert (data.time.attrs, data.stamp_ns.attrs) == ({'units': 's'}, {'units': 'ns'})
    assert (int(data.stamp_ns[0]), data.attrs) == (flight.start, {'start_ns': flight.start})
    x.to_netcdf(tmp_path / 'x.nc', engine='scipy')
    assert xarray.load_dataarray(tmp_path / 'x.nc', engine='scipy').attrs['units'] == 'm'


@pytest.mark.parametrize('topics', [('light', 'light/peaks'), ('light/peaks', 'light')])
def test_a_topic_whose_name_begins_that_of_another_lends_it_no_frame(topics):
    aligned = pandas.DataFrame({STAMP_COLUMN: [0], 'light/x': [1.0], 'light/peaks/x': [2.0]})
    aligned.attrs = {'units': {}, 'start': 0}
    tables = {name: pandas.DataFrame({'header.frame_id': [f'of {name}']}) for name in topics}
    data = build_dataset(aligned, tables)
    assert data['light.x'].attrs == {'frame': 'of light'}
    assert data['light.peaks.x'].attrs == {'frame': 'of light/peaks'}


def test_a_clock_is_that_of_align_topics(flight):
    x = flight.to_xarray('odom', rate=200.0, method='linear')['odom.pose.pose.position.x']
    np.testing.assert_allclose(x.sel(time=0.105, method='nearest'), 1.05)


def test_a_plot_has_units_and_draws_in_other_axes(flight):
    axes = flight.plot('odom', 'pose.pose.position')
    assert (axes.get_xlabel(), axes.get_ylabel()) == ('time [s]', 'pose.pose.position [m]')
    _, y, _ = axes.get_lines()
    np.testing.assert_array_equal(y.get_ydata(), -0.2 * np.arange(40))
    np.testing.assert_allclose(y.get_xdata(), 0.01 * np.arange(40), atol=1e-12)
    assert flight.plot('odom', 'pose.pose.orientation.yaw', axes=axes) is axes
    assert axes.get_ylabel() == 'pose.pose.orientation.yaw [rad]'
    assert axes.get_legend().get_texts()[3].get_text() == 'odom pose.pose.orientation.yaw'


@pytest.mark.parametrize(
    ('columns', 'message'),
    [
        ((), 'No columns to plot'),
        (('pose.pose.position.q',), "Unknown column of odom 'pose.pose.position.q'"),
        (('pose.pose.position', 'twist.twist.linear'), r'several units \(m, m/s\)'),
    ],
)
def test_what_cannot_be_plotted_is_said(flight, columns, message):
    with pytest.raises(BadInput, match=message):
        flight.plot('odom', *columns)


def test_a_missing_package_is_named(flight, monkeypatch):
    monkeypatch.setitem(sys.modules, 'xarray', None)
    with pytest.raises(BadInput, match='pip install xarray'):
        flight.to_xarray('odom')
    monkeypatch.setitem(sys.modules, 'matplotlib.pyplot', None)
    with pytest.raises(BadInput, match='pip install matplotlib'):
        flight.plot('odom', 'pose.pose.position')
