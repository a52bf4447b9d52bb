# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plot what the photodiodes measure of the lamp: by direction, as samples and as spectrum."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from lta_config.topics import load_topic_table
from lta_flight.report.results import beacon_direction, find_phases
from lta_flight.report.view import FlightView
from lta_report.curves import Array, interpolate
from lta_report.drawing import (
    build_line_trace,
    create_figure,
    EndLabel,
    label_ends,
    padded_range,
)
from lta_report.palette import (
    build_color_scale,
    ESTIMATE,
    GOOD,
    HEAT,
    LAMP,
    SOFT,
    TRUTH,
    WALL,
)
from lta_vlc.spectral.spectrum import amplitude_spectrum
import numpy as np
from plotly.graph_objects import Figure, Heatmap, Scatter


def create_time_figure(
    view: FlightView, rows: int = 1, heights: Sequence[float] | None = None
) -> Figure:
    """Return an empty figure over the time of the flight, with its phases marked."""
    figure = create_figure(rows, heights)
    figure.update_xaxes(range=list(view.span), hoverformat='.2f', unifiedhovertitle_text='%{x} s')
    figure.update_xaxes(title_text='time [s]', row=rows)
    phases = find_phases(view)
    marks = (
        (phases.lift_off, 'lift-off', 'right'),
        (phases.search, 'search', 'left'),
        (phases.end, 'at the lamp', 'right'),
    )
    # False for NaN, a phase that never began
    visible = [mark for mark in marks if view.span[0] < mark[0] < view.span[1]]
    # All at once: to add one, plotly copies those that are there
    return figure.update_layout(
        shapes=[
            {
                'type': 'line', 'x0': time, 'x1': time, 'y0': 0.0, 'y1': 1.0,
                'yref': 'paper', 'layer': 'below',
                'line': {'color': WALL, 'width': 1, 'dash': '2px,3px'},
            }
            for time, _, _ in visible
        ],
        annotations=[
            {
                'x': time, 'y': 1.0, 'yref': 'paper', 'yanchor': 'bottom', 'text': text,
                'xanchor': side, 'font': {'size': 10, 'color': SOFT},
            }
            for time, text, side in visible
        ],
    )  # fmt: skip


BLOCK_COLOURS: Final = (TRUTH, ESTIMATE)
MOST_COLUMNS = 1000  # columns of the map, about the pixels of a panel
FAINTEST_COUNTS = 0.1  # counts; below it there is only noise of the converter
HIGHEST = 1000.0  # Hz; above it there are only higher harmonics
LEAST_COUNTS = 1e-3  # counts, the least value on the logarithmic axis


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
    finite = np.nan_to_num(
        amplitude, nan=FAINTEST_COUNTS, posinf=FAINTEST_COUNTS, neginf=FAINTEST_COUNTS
    )
    levels = np.log10(np.maximum(finite, FAINTEST_COUNTS)).astype(np.float32)
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


class SampleBlock(NamedTuple):
    """Samples over time of one diode in a block, and a label with the place."""

    where: str
    colour: str
    time: Array  # in the block [s]
    samples: Array  # [counts]


def select_sample_blocks(view: FlightView) -> list[SampleBlock]:
    """Return the blocks at the start and at the end of the search."""
    time = view.read_table('photodiodes').index.to_numpy()
    phases = find_phases(view)
    searched = np.flatnonzero(
        # A block must lie within the search as a whole
        (time >= phases.search) & (time <= phases.end - 2 * view.half_block_time)
    )
    # A flight without a search shows the ends of the recording
    chosen = searched if len(searched) else np.arange(len(time))
    rate = load_topic_table().light.sample_rate.si
    blocks = []
    ends = (int(chosen[0]), int(chosen[-1]))
    for k, samples, colour in zip(ends, view.read_blocks(ends), BLOCK_COLOURS, strict=True):
        block = samples.astype(np.float64)
        # The lamp modulates the light, so its diode has the largest deviation
        brightest = block[:, block.std(axis=0).argmax()]
        blocks.append(
            SampleBlock(
                format_lamp_distance(view, float(time[k])),
                colour,
                np.arange(len(block)) / rate,
                brightest,
            )
        )
    return blocks


def format_lamp_distance(view: FlightView, time: float) -> str:
    """Return the distance of the drone from the lamp, in words."""
    if not view.goal.places or not view.has_topics('ground_truth/odom'):
        return f'at {time:.1f} s'
    away = view.goal.lamp_distance(view.truth)
    return f'{float(interpolate(np.array([time]), view.truth.time, away)[0]):.1f} m from the lamp'


def plot_samples(view: FlightView) -> Figure:
    """Return a figure of the brightest diode's samples in two blocks."""
    figure = create_figure(2)
    for row, moment in enumerate(select_sample_blocks(view), start=1):
        figure.add_trace(
            Scatter(
                x=(1e3 * moment.time).astype(np.float32),
                # ADC counts fit into 16 bits, which keeps the page small
                y=moment.samples.astype(np.uint16),
                mode='lines',
                line={'color': moment.colour, 'width': 1},
                name=moment.where,
                hovertemplate='%{y} counts',
            ),
            row=row,
            col=1,
        )
        label = EndLabel(moment.where, float(moment.samples.mean()), moment.colour)
        label_ends(figure, [label], padded_range(moment.samples), row)
        figure.update_yaxes(title_text='light [counts]', row=row)
    figure.update_xaxes(title_text='time since the start of the block [ms]', row=2)
    figure.update_xaxes(hoverformat='.1f', unifiedhovertitle_text='%{x} ms')
    return figure


def plot_spectrum(view: FlightView) -> Figure:
    """Return a figure of the spectra of two blocks, with lamp and mains marked."""
    figure = create_figure()
    labels = []
    peaks = []
    for moment in select_sample_blocks(view):
        rate = 1.0 / (moment.time[1] - moment.time[0])
        amplitude = amplitude_spectrum(moment.samples[:, None])[:, 0]
        frequency = np.fft.rfftfreq(len(moment.samples), 1.0 / rate)
        in_range = (frequency > 0.0) & (frequency <= HIGHEST)
        values = np.maximum(amplitude[in_range], LEAST_COUNTS)
        figure.add_trace(
            Scatter(
                x=frequency[in_range].astype(np.float32),
                y=values.astype(np.float32),
                mode='lines',
                line={'color': moment.colour, 'width': 1.4},
                name=moment.where,
                hovertemplate='%{y:.3~g} counts',
            )
        )
        peaks.append(np.log10(values))
        labels.append(EndLabel(moment.where, peaks[-1][-1], moment.colour))
    # The axis is in decades; 0.45 leaves space for the labels above the peaks
    low = float(np.floor(min(np.quantile(peak, 0.02) for peak in peaks)))
    high = float(max(peak.max() for peak in peaks)) + 0.45
    figure.update_yaxes(title_text='amplitude [counts]', type='log', dtick=1)
    label_ends(figure, labels, (low, high))
    figure.update_xaxes(title_text='frequency [Hz]', range=[0, HIGHEST], tickangle=0)
    figure.update_xaxes(unifiedhovertitle_text='%{x} Hz')
    label_frequencies(figure, view)
    return figure


def label_frequencies(figure: Figure, view: FlightView) -> None:
    """Label the fundamental of each lamp, harmonics of a single lamp, and the mains flicker."""
    scenario = view.scene.scenario
    if scenario is None:
        return
    mains = scenario.ambient.mains_frequency.si
    marks = [(mains, 'mains', SOFT, 'right')]
    marks += [(beat, f'{name} {beat:g} Hz', LAMP, 'left') for name, beat in scenario.beacons]
    if len(scenario.beacons) == 1:
        ((_, beat),) = scenario.beacons
        # The odd harmonics of a square wave
        marks += [(k * beat, f'{k} f', LAMP, 'left') for k in (3, 5) if k * beat <= HIGHEST]
    harmonics = {f'{k} f' for k in (3, 5)}
    for frequency, text, colour, side in marks:
        figure.add_vline(
            frequency, line={'color': colour, 'width': 1, 'dash': 'dot'}, layer='below'
        )
        figure.add_annotation(
            x=frequency, y=1.0, yref='paper', xanchor=side,
            # Harmonics inside the axes, or the name of the lamp would cover them
            yanchor='top' if text in harmonics else 'bottom',
            text=text, font={'color': colour, 'size': 11},
        )  # fmt: skip
