# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The figures of a flight page, in reading order, and those of its motion and power."""

from collections.abc import Callable, Sequence
from typing import Final, final, NamedTuple

from lta_data.compare.sampling import wrap_angle
from lta_flight.report.light_panels import (
    create_time_figure,
    plot_light,
    plot_samples,
    plot_spectrum,
)
from lta_flight.report.path import plot_path
from lta_flight.report.results import find_phases
from lta_flight.report.view import FlightView
from lta_report.curves import Array, hold_last, interpolate
from lta_report.drawing import (
    build_dot_trace,
    build_line_trace,
    decimate_line,
    EndLabel,
    label_ends,
    padded_range,
)
from lta_report.palette import ESTIMATE, FILL, GOOD, INK, LAMP, RAW, SETPOINT, TRUTH
import numpy as np
from plotly.graph_objects import Figure, Scatter


class FlightLine(NamedTuple):
    """A line over the time of a flight, in the unit of its axis, with its name at its end."""

    name: str
    time: Array  # [s]
    values: Array
    colour: str
    words: str = ''  # at the end, in place of the name
    scale: Array | None = None  # values that the axis shows, in place of all


def draw_lines(
    figure: Figure, lines: Sequence[FlightLine], title: str, unit: str, row: int = 1,
    pad: float = 0.08,
) -> Figure:  # fmt: skip
    """Draw lines in a row of a figure; a set-point is held between messages, and dotted."""
    for each in lines:
        held = each.name == 'set-point'
        thin = held or each.colour == LAMP
        trace = build_line_trace(
            each.name, each.time, each.values, each.colour, unit=unit,
            width=1.2 if thin else 1.6, dash='dot' if held else 'solid', steps=held,
        )  # fmt: skip
        figure.add_trace(trace, row=row, col=1)
    labels = [
        EndLabel(each.words or each.name, float(each.values[-1]), each.colour) for each in lines
    ]
    scales = (each.values if each.scale is None else each.scale for each in lines)
    figure.update_yaxes(title_text=f'{title} [{unit}]', row=row)
    label_ends(figure, labels, padded_range(*scales, pad=pad), row)
    return figure


def plot_airspeed(view: FlightView) -> Figure:
    """Return a figure of true, estimated and commanded forward airspeed."""
    lines = []
    if view.has_topics('setpoint/velocity'):
        lines.append(FlightLine('set-point', *view.speed_setpoint, SETPOINT))
    if view.has_topics('odom'):
        lines.append(FlightLine('estimate', view.estimate.time, view.estimate.speed, ESTIMATE))
    lines.append(FlightLine('truth', view.truth.time, view.truth.speed, TRUTH))
    return draw_lines(create_time_figure(view), lines, 'forward airspeed', 'm/s')


def plot_altitude(view: FlightView) -> Figure:
    """Return a figure of truth, estimate, set-point and raw range."""
    figure, truth, lines = create_time_figure(view), view.truth, []
    if view.has_topics('range'):
        # First, so that the lines are drawn over the dots
        figure.add_trace(build_dot_trace('range', *view.range_altitude, RAW, unit='m'))
    if view.has_topics('setpoint/pose'):
        setpoint = view.altitude_setpoint
        # The set-point before lift-off must not widen the axis
        flying = hold_last(truth.time[truth.time >= find_phases(view).lift_off], setpoint)
        lines.append(FlightLine('set-point', *setpoint, SETPOINT, scale=flying))
    if view.has_topics('odom'):
        lines.append(FlightLine('estimate', view.estimate.time, view.estimate.z, ESTIMATE))
    lines.append(FlightLine('truth', truth.time, truth.z, TRUTH))
    return draw_lines(figure, lines, 'altitude', 'm', pad=0.15)


def plot_heading(view: FlightView) -> Figure:
    """Return a figure of true, estimated and commanded heading and of the lamp's direction."""
    truth, lines = view.truth, []
    heading = np.degrees(truth.yaw)
    if view.goal.places:
        # The direction is in the body frame
        lamp = heading + np.degrees(view.goal.lamp_direction(truth))
        lines.append(FlightLine('to the lamp', truth.time, lamp, LAMP))
    if view.has_topics('odom', 'setpoint/pose'):
        time, setpoint = view.heading_setpoint
        estimate = interpolate(time, view.estimate.time, view.estimate.yaw)
        # Shift the set-point by full turns to the estimate, so that the lines stay together
        setpoint = np.degrees(estimate + wrap_angle(setpoint - estimate))
        lines.append(FlightLine('set-point', time, setpoint, SETPOINT))
    if view.has_topics('odom'):
        own = np.degrees(view.estimate.yaw)
        lines.append(FlightLine('estimate', view.estimate.time, own, ESTIMATE))
    lines.append(FlightLine('truth', truth.time, heading, TRUTH))
    return draw_lines(create_time_figure(view), lines, 'heading', '°')


def plot_power(view: FlightView) -> Figure:
    """Return a figure of battery power, panel power, and energy drawn from the battery."""
    figure = create_time_figure(view, 2)
    time, voltage, current = view.battery
    power = -voltage * current
    # The axis always includes zero
    lines = [FlightLine('cell', time, power, ESTIMATE, 'out of cell', np.append(power, 0.0))]
    if view.has_topics('panel'):
        when, volts, amperes = view.panel
        lines.append(FlightLine('panel', when, volts * amperes, GOOD, 'from panel'))
    # By the trapezoidal rule, from 0 J; scipy would take a tenth of a second to import
    steps = np.diff(time) * (power[1:] + power[:-1]) / 2.0
    energy = np.concatenate([[0.0], np.cumsum(steps)])
    total = FlightLine('energy', time, energy, ESTIMATE, f'{energy[-1]:.1f} J in all')
    draw_lines(figure, lines, 'power', 'W')
    return draw_lines(figure, [total], 'energy', 'J', row=2)


def plot_duty(view: FlightView) -> Figure:
    """Return a figure of the commanded duties with a row per rotor."""
    time, names, values = view.duties
    figure = create_time_figure(view, len(names))
    # Show negative duties only if a rotor has reversed
    low = -1.05 if values.min() < 0.0 else -0.03
    for row, name in enumerate(names, start=1):
        x, y = decimate_line(time, values[:, row - 1])
        figure.add_trace(
            Scatter(
                x=x, y=y, name=name, fill='tozeroy', fillcolor=FILL, mode='lines',
                line={'color': TRUTH, 'width': 1, 'shape': 'hv'}, hovertemplate='%{y:.2f}',
            ),
            row=row, col=1,
        )  # fmt: skip
        figure.update_yaxes(range=[low, 1.05], tickvals=[0, 1], row=row)
        figure.add_annotation(
            x=1.0, xref='x domain', y=0.5, yref='y domain', xanchor='left', xshift=6,
            # A line per word, because the margin is narrow
            align='left', text=name.replace('_', '<br>'), font={'color': INK, 'size': 11},
            row=row, col=1,
        )  # fmt: skip
    figure.update_yaxes(title_text='duty [1]', row=int(np.ceil(len(names) / 2)))
    return figure


@final
class FlightPanel(NamedTuple):
    """One figure of the page."""

    name: str  # identifier in the page and in file names
    title: str  # heading
    caption: str  # what the figure shows, in a sentence or two
    needs: tuple[str, ...]  # required topics
    picture: Callable[[FlightView], Figure]  # builds the figure from the flight
    timed: bool = True  # whether the x axis is the time of the flight


FLIGHT_PANELS: Final = (
    FlightPanel(
        'path',
        'From above',
        'The true path, coloured and labelled by time. Short rays are the measured bearings to '
        'the lamp, darker with a better signal. The dotted line is the path by dead reckoning, '
        'the dashed circle the goal. '
        'Shading is the direct light of all lamps at flight height; each step is a factor of two.',
        ('ground_truth/odom',),
        plot_path,
        timed=False,
    ),
    FlightPanel(
        'altitude',
        'Altitude',
        'Height of the hull centre above the floor. Grey dots are raw readings of the range '
        'finder, converted to the height of the hull centre.',
        ('ground_truth/odom',),
        plot_altitude,
    ),
    FlightPanel(
        'airspeed',
        'Airspeed',
        'Speed through the air along the nose. The estimate fuses the accelerometer with a drag '
        'model.',
        ('ground_truth/odom',),
        plot_airspeed,
    ),
    FlightPanel(
        'heading',
        'Heading',
        'Direction of the nose in the frame of the room. For comparison, the estimate is shifted '
        'here to start at the true heading; on board it starts at zero.',
        ('ground_truth/odom',),
        plot_heading,
    ),
    FlightPanel(
        'light',
        'Light by direction',
        'Amplitude at the frequency of the lamp for each photodiode of the ring, with the nose in '
        'the middle. The line is the true direction to the lamp, the dots are the measured '
        'bearing.',
        ('light/peaks',),
        plot_light,
    ),
    FlightPanel(
        'duty',
        'Rotors',
        'Duty that the controller commands for each rotor.',
        ('motors',),
        plot_duty,
    ),
    FlightPanel(
        'power',
        'Power and energy',
        'Electrical power out of the cell and from the solar panel, and the energy taken from the '
        'cell since the recording started, including time on the ground.',
        ('battery',),
        plot_power,
    ),
    FlightPanel(
        'samples',
        'Samples of a photodiode',
        'A tenth of a second of raw samples of the brightest photodiode, at the start and at the '
        'end of the search.',
        ('photodiodes',),
        plot_samples,
        timed=False,
    ),
    FlightPanel(
        'spectrum',
        'Spectrum of a photodiode',
        'Spectrum of the same samples. The peak of the lamp is separate from the flicker of mains '
        'lighting. Its odd harmonics are those of a square wave, and the small peaks between them '
        'are higher harmonics aliased by the sampling.',
        ('photodiodes',),
        plot_spectrum,
        timed=False,
    ),
)
