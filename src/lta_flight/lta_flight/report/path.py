# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plot the path of a flight from above, with the measured bearings, one per second."""

import math

from lta_flight.report.results import find_phases
from lta_flight.report.view import FlightView
from lta_model.light.lamp import BeaconLamp, direct_illuminance
from lta_model.scenario import Scenario
from lta_model.scenario_light import LampScene
from lta_report.curves import Array, interpolate
from lta_report.drawing import create_figure
from lta_report.palette import (
    build_color_scale,
    ESTIMATE,
    GLOW,
    GOOD,
    INK,
    LAMP,
    PAPER,
    SOFT,
    STRENGTH,
    TIME,
    VEIL,
    WALL,
)
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Contour, Figure, Scatter

LAMP_LABEL_SHIFT = 25.0  # px up, or down near the upper wall
PATH_POINTS = 700  # points of the path, which together look like a ribbon
ROOM_MARGIN = 0.25  # m around the room
LABEL_STEPS = (1, 2, 5, 10, 20, 60)  # s between the time labels of the path
MOST_STEPS = 12  # labels, of which some would overlap others
# Of the longer side of the room or path; closer labels would overlap on a phone
LABEL_GAP = 0.1
RAY_LENGTH = 0.75  # m of a ray; long enough to show a direction, short enough not to hide the next
RAY_PERIOD = 1.0  # s between two rays


def plot_path(view: FlightView) -> Figure:
    """Return a figure of the true path in the room, with light and measured bearings."""
    figure = create_figure()
    figure.update_layout(hovermode='closest', margin={'l': 44, 'r': 12, 't': 8, 'b': 40})
    if view.scene.scenario is not None:
        # The light is drawn at the median flight height
        draw_room(figure, view.scene.scenario, float(np.median(view.truth.z)))
    if view.has_topics('light/bearing', 'light/peaks'):
        draw_rays(figure, view)
    if view.has_topics('odom'):
        draw_estimate(figure, view)
    figure.add_trace(build_colored_path(view))
    draw_times(figure, view)
    set_axis_ranges(figure, view)
    return figure


def set_axis_ranges(figure: Figure, view: FlightView) -> None:
    """Show the whole room, or the whole path, with equal scales of both axes."""
    if view.scene.scenario is not None:
        length, width, _ = view.scene.scenario.room.size.vector
        sides = [(-length / 2, length / 2), (-width / 2, width / 2)]
    else:
        sides = [(part.min() - 1.0, part.max() + 1.0) for part in (view.truth.x, view.truth.y)]
    (left, right), (low, high) = sides
    step = choose_tick_distance(max(right - left, high - low))
    shared = {'showgrid': False, 'dtick': step, 'constrain': 'domain'}
    figure.update_xaxes(
        range=[left - ROOM_MARGIN, right + ROOM_MARGIN], title_text='x [m]', **shared
    )
    figure.update_yaxes(
        range=[low - ROOM_MARGIN, high + ROOM_MARGIN],
        title_text='y [m]',
        scaleanchor='x',
        constraintoward='top',
        **shared,
    )


def draw_estimate(figure: Figure, view: FlightView) -> None:
    """Draw the path by dead reckoning."""
    estimate = view.estimate
    # Every n-th point, for about PATH_POINTS in all
    keep = slice(None, None, max(1, len(estimate.time) // PATH_POINTS))
    figure.add_trace(
        Scatter(
            x=estimate.x[keep].astype(np.float32),
            y=estimate.y[keep].astype(np.float32),
            mode='lines',
            line={'color': ESTIMATE, 'width': 1.3, 'dash': 'dot'},
            name='dead reckoning',
            hoverinfo='skip',
        )
    )


def build_colored_path(view: FlightView) -> Scatter:
    """Return the true path as points coloured by time."""
    truth = view.truth
    keep = slice(None, None, max(1, len(truth.time) // PATH_POINTS))
    time = truth.time[keep].astype(np.float32)
    return Scatter(
        x=truth.x[keep].astype(np.float32),
        y=truth.y[keep].astype(np.float32),
        customdata=np.stack([time, truth.z[keep].astype(np.float32)], axis=1),
        mode='markers',
        marker={'color': time, 'colorscale': build_color_scale(TIME), 'size': 4.5},
        name='path',
        hovertemplate='%{customdata[0]:.1f} s<br>x %{x:.2f} m, y %{y:.2f} m, '
        'z %{customdata[1]:.2f} m<extra></extra>',
    )


def draw_times(figure: Figure, view: FlightView) -> None:
    """Label the path with times, on the side away from the lamp."""
    phases = find_phases(view)
    start = phases.search if np.isfinite(phases.search) else view.span[0]
    # The smallest step that gives few enough labels; beyond the list, a multiple of its last
    length = phases.end - start
    step = next(
        (step for step in LABEL_STEPS if length / step <= MOST_STEPS),
        LABEL_STEPS[-1] * math.ceil(length / (LABEL_STEPS[-1] * MOST_STEPS)),
    )
    truth = view.truth
    size = max(float(np.ptp(part)) for part in (truth.x, truth.y))
    labelled: list[tuple[float, ...]] = []
    if (scenario := view.scene.scenario) is not None:
        size = max(scenario.room.size.vector[:2])
        labelled = [
            scenario.start.position.vector[:2],
            *(lamp.position.vector[:2] for lamp in scenario.lamps.values()),
        ]
    for time in np.arange(np.ceil(start / step) * step, phases.end, step):
        # Position now and half a second later, for the direction of flight
        x, y, ahead_x, ahead_y = (
            float(np.interp(when, truth.time, part))
            for when in (time, time + 0.5)
            for part in (truth.x, truth.y)
        )
        if any(math.dist((x, y), other) < LABEL_GAP * size for other in labelled):
            continue
        labelled.append((x, y))
        course = np.arctan2(ahead_y - y, ahead_x - x)
        # Unit vector to the left of the path
        across, up = -np.sin(course), np.cos(course)
        if places := view.goal.places:
            lamp = places[int(view.goal.leg_index(np.array([time]))[0])]
            # Negative if the left side faces the lamp
            away = -1.0 if across * (lamp.x - x) + up * (lamp.y - y) > 0.0 else 1.0
            across, up = away * across, away * up
        draw_label(figure, (x, y), f'{time:g} s', SOFT, 20.0 * across, 14.0 * up)


def select_per_period(time: Array, start: float, end: float) -> NDArray[np.intp]:
    """Return the first sample of each period between two times, if there is one."""
    inside = np.flatnonzero((time >= start) & (time < end))
    _, first = np.unique(np.floor((time[inside] - start) / RAY_PERIOD), return_index=True)
    return inside[first]


def draw_rays(figure: Figure, view: FlightView) -> None:
    """Draw short rays along the measured bearings, darker for a better SNR."""
    time, angle = view.bearing
    phases = find_phases(view)
    start = phases.search if np.isfinite(phases.search) else view.span[0]
    chosen = select_per_period(time, start, phases.end)
    # Blocks without a bearing have no ray
    chosen = chosen[np.isfinite(angle[chosen])]
    if not len(chosen):
        return
    truth = view.truth
    x, y, yaw = (
        interpolate(time[chosen], truth.time, part) for part in (truth.x, truth.y, truth.yaw)
    )
    peak_time, parts = view.peaks
    snr = interpolate(time[chosen], peak_time, parts['snr'].max(axis=1))
    # Bearings are in the body frame, the plan is in map
    course = yaw + angle[chosen]
    # The SNR spans orders of magnitude, so grade its logarithm
    shades = assign_shades(np.log(np.maximum(snr, 1.0)))
    for grade, colour in enumerate(STRENGTH):
        strong = shades == grade
        if strong.any():
            figure.add_trace(build_ray_line(x[strong], y[strong], course[strong], colour))
    key = ''.join(
        f'<span style="color:{colour}">\N{BOX DRAWINGS HEAVY HORIZONTAL}</span>'
        for colour in STRENGTH
    )
    figure.add_annotation(
        x=0.03,
        y=0.03,
        xref='x domain',
        yref='y domain',
        xanchor='left',
        text=f'bearing, SNR {snr.min():.0f} {key} {snr.max():.0f}',
        font={'color': SOFT, 'size': 11},
    )


def assign_shades(values: Array) -> Array:
    """Return the index of the shade of each value, from least to greatest."""
    # Equal values all get the first shade
    span = float(np.ptp(values)) or 1.0
    share = (values - values.min()) / span
    return np.asarray(np.minimum(share * len(STRENGTH), len(STRENGTH) - 1).astype(int))


def build_ray_line(x: Array, y: Array, course: Array, colour: str) -> Scatter:
    """Return rays of one colour as a single line with gaps."""
    # A NaN after each ray interrupts the line; one trace draws faster than many
    gap = np.full(len(x), np.nan)
    return Scatter(
        x=np.stack([x, x + RAY_LENGTH * np.cos(course), gap], axis=1).ravel().astype(np.float32),
        y=np.stack([y, y + RAY_LENGTH * np.sin(course), gap], axis=1).ravel().astype(np.float32),
        mode='lines',
        line={'color': colour, 'width': 1.8},
        name='bearing',
        hoverinfo='skip',
    )


MOST_TICKS = 12
CELL = 0.1  # m, grid of the shading
MOST_CELLS_PER_SIDE = 160  # per side; a hall gets larger cells
FAINTEST_LIGHT, BRIGHTEST = 3.0, 12.0  # log2 of lx: the shading covers 8 to 4096 lx


def choose_tick_distance(side: float) -> float:
    """Return the distance of ticks along the longer side of a room [m]."""
    return next(step for step in (1.0, 2.0, 5.0, 10.0, 50.0, side) if side <= MOST_TICKS * step)


def draw_label(
    figure: Figure, place: tuple[float, float], text: str, colour: str, across: float, up: float
) -> None:
    """Write a word at some distance in px from a point on the floor."""
    figure.add_annotation(
        x=place[0],
        y=place[1],
        xshift=across,
        yshift=up,
        text=text,
        font={'color': colour, 'size': 11},
        bgcolor=VEIL,
        borderpad=1,
    )


def draw_room(figure: Figure, scenario: Scenario, height: float) -> None:
    """Draw the room of a scenario, with the light at some height [m]."""
    figure.add_trace(build_light_contour(scenario, height))
    length, width, _ = scenario.room.size.vector
    figure.add_shape(
        type='rect', x0=-length / 2, x1=length / 2, y0=-width / 2, y1=width / 2,
        line={'color': WALL, 'width': 3}, layer='below',
    )  # fmt: skip
    draw_goals(figure, scenario)
    for name, lamp in scenario.lamps.items():
        is_high = lamp.position.vector[1] > width / 4
        draw_lamp(figure, name, lamp, -LAMP_LABEL_SHIFT if is_high else LAMP_LABEL_SHIFT)
    x, y = scenario.start.position.vector
    figure.add_trace(
        Scatter(
            x=[x], y=[y], mode='markers', name='start', hoverinfo='skip',
            marker={'symbol': 'circle-open', 'size': 10, 'color': INK, 'line': {'width': 1.5}},
        )
    )  # fmt: skip
    draw_label(figure, (x, y), 'start', INK, 0, -16)


def draw_goals(figure: Figure, scenario: Scenario) -> None:
    """Draw the goal circle of each target lamp."""
    radius = scenario.goal.radius.si
    for x, y in scenario.goal_places:
        figure.add_shape(
            type='circle', x0=x - radius, x1=x + radius, y0=y - radius, y1=y + radius,
            line={'color': GOOD, 'width': 1.5, 'dash': 'dash'},
        )  # fmt: skip


def draw_lamp(figure: Figure, name: str, lamp: LampScene, up: float) -> None:
    """Draw a lamp with its orientation, and its name that far above it [px]."""
    x, y, _ = lamp.position.vector
    ahead, left, _ = lamp.facing.vector
    facing, frequency = math.degrees(math.atan2(left, ahead)), lamp.frequency.si
    figure.add_trace(
        Scatter(
            x=[x], y=[y], mode='markers', name=name,
            marker={
                'symbol': 'triangle-up', 'size': 15, 'color': LAMP,
                # Plotly rotates clockwise from up, facing is counter-clockwise from x
                'angle': 90.0 - facing, 'line': {'color': PAPER, 'width': 1.5},
            },
            hovertemplate=f'{name}, {frequency:g} Hz<extra></extra>',
        )
    )  # fmt: skip
    draw_label(figure, (x, y), f'{name}<br>{frequency:g} Hz', LAMP, 0, up)


def build_light_contour(scenario: Scenario, height: float) -> Contour:
    """Return contours of the lamps' direct light at a height, a factor of two apart."""
    length, width, _ = scenario.room.size.vector
    x, y = (
        np.linspace(-side / 2, side / 2, min(round(side / CELL), MOST_CELLS_PER_SIDE) + 1)
        for side in (length, width)
    )
    points = np.stack([*np.meshgrid(x, y), np.full((len(y), len(x)), height)], axis=-1)
    # Direct light only; reflections would hide the pattern of the lamps
    light = sum(lamp_illuminance(lamp, points) for lamp in scenario.light_field.lamps)
    return Contour(
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        z=np.log2(np.maximum(light, 1.0)).astype(np.float32),
        name='light of the lamps',
        colorscale=build_color_scale(GLOW),
        showscale=False,
        zmin=FAINTEST_LIGHT,
        zmax=BRIGHTEST,
        # One contour per factor of two
        contours={'start': FAINTEST_LIGHT + 1, 'end': BRIGHTEST, 'size': 1, 'coloring': 'fill'},
        line={'width': 0},
        hoverinfo='skip',
    )


def lamp_illuminance(lamp: BeaconLamp, points: Array) -> Array:
    """
    Return the illuminance by a lamp on planes that face it.

    `points`, shape (..., 3): positions [m, map]. The result has shape (...) [lx].
    """
    towards = np.array(lamp.position) - points
    # The minimum avoids a division by zero in the lamp itself
    towards /= np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), CELL)
    return direct_illuminance(lamp, points, towards)
