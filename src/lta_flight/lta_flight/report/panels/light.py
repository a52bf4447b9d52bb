"""Plot what the ring of photodiodes measures of the lamp."""

from lta_flight.report.results import beacon_direction
from lta_flight.report.time_figure import create_time_figure
from lta_flight.report.view import FlightView
from lta_report.curves import Array
from lta_report.drawing import build_line_trace, EndLabel, label_ends, padded_range
from lta_report.palette import build_color_scale, ESTIMATE, GOOD, HEAT, LAMP, SOFT
import numpy as np
from plotly.graph_objects import Figure, Heatmap, Scatter

MOST_COLUMNS = 1000  # columns of the map, about the pixels of a panel
FAINTEST = 0.1  # counts; below it there is only noise of the converter


def plot_light(view: FlightView) -> Figure:
    """Return a figure of amplitude by direction and time, and of the best diode's SNR."""
    figure = create_time_figure(view, 2, (0.66, 0.34))
    time, parts = view.peaks
    azimuth = np.degrees(np.arctan2(parts['y'][0], parts['x'][0])).round(1)
    # A heat map needs its rows in ascending order
    order = np.argsort(azimuth)
    amplitude = parts['amplitude'][:, order].T
    averages = average_stretches(time), azimuth[order], average_stretches(amplitude)
    figure.add_trace(build_amplitude_map(*averages), row=1, col=1)
    if view.has_topics('light/bearing'):
        figure.add_trace(build_bearing_trace(view), row=1, col=1)
    if view.has_topics('ground_truth/odom') and view.goal.places:
        truth = view.truth
        angle = insert_wrap_gaps(np.degrees(beacon_direction(view, truth)))
        figure.add_trace(
            build_line_trace('true', truth.time, angle, LAMP, unit='°', width=1.4), row=1, col=1
        )
    figure.update_yaxes(
        title_text='direction, left of the nose [°]', tickvals=[-90, 0, 90, 180], row=1
    )
    best = parts['snr'].max(axis=1)
    # The axis is logarithmic, so its range is in decades
    snr = np.log10(np.maximum(best, 0.1))
    figure.add_trace(build_snr_trace(time, best), row=2, col=1)
    figure.update_yaxes(title_text='SNR [1]', type='log', row=2)
    low, high = padded_range(snr)
    figure.update_yaxes(range=[low, high], nticks=4, row=2)
    label_ends(figure, [EndLabel('best diode', float(snr[-1]), GOOD)], (low, high), row=2)
    return figure


def build_amplitude_map(time: Array, azimuth: Array, amplitude: Array) -> Heatmap:
    """Return a map of the lamp's amplitude over time and direction, on a log scale."""
    # A dead diode has no amplitude and is drawn as the faintest
    finite = np.nan_to_num(amplitude, nan=FAINTEST, posinf=FAINTEST, neginf=FAINTEST)
    levels = np.log10(np.maximum(finite, FAINTEST)).astype(np.float32)
    low, high = np.floor(levels.min()), np.ceil(levels.max())
    ticks = np.arange(low, high + 1)
    return Heatmap(
        x=time.astype(np.float32),
        y=azimuth,
        z=levels,
        customdata=amplitude.astype(np.float32),
        colorscale=build_color_scale(HEAT),
        zmin=low,
        zmax=high,
        name='amplitude',
        hovertemplate='diode at %{y}°: %{customdata:.1f} counts<extra></extra>',
        colorbar={
            'thickness': 8,
            'len': 0.6,
            'y': 1.0,
            'yanchor': 'top',
            'outlinewidth': 0,
            'tickvals': ticks,
            'ticktext': [f'{10.0**tick:g}' for tick in ticks],
            'tickfont': {'color': SOFT, 'size': 10},
            'title': {'text': 'counts', 'side': 'right', 'font': {'color': SOFT, 'size': 10}},
        },
    )


def average_stretches(values: Array) -> Array:
    """Return means over equal intervals of the last axis, at most `MOST_COLUMNS`."""
    count = values.shape[-1]
    # The length of an interval, rounded up
    starts = np.arange(0, count, -(-count // MOST_COLUMNS))
    lengths = np.diff(np.append(starts, count))
    return np.asarray(np.add.reduceat(values, starts, axis=-1) / lengths)


def build_bearing_trace(view: FlightView) -> Scatter:
    """Return the measured bearings as dots."""
    time, angle = view.bearing
    return Scatter(
        x=time.astype(np.float32),
        y=np.degrees(angle).astype(np.float32),
        mode='markers',
        marker={'color': ESTIMATE, 'size': 4},
        name='measured',
        hovertemplate='%{y:.1f}°',
    )


def build_snr_trace(time: Array, best: Array) -> Scatter:
    """Return the SNR of the best diode."""
    return build_line_trace('best diode', time, np.maximum(best, 0.1), GOOD, unit='')


def insert_wrap_gaps(angle: Array) -> Array:
    """Return an angle in degrees with NaN where it wraps, so that no line crosses the plot."""
    result = angle.copy()
    result[1:][np.abs(np.diff(angle)) > 180.0] = np.nan
    return result
