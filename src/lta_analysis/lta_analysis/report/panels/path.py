"""The flight from above."""

from lta_analysis.report.drawing import blank
from lta_analysis.report.palette import (
    ESTIMATE,
    GLOW,
    GOOD,
    INK,
    LAMP,
    PAPER,
    scale,
    SOFT,
    STRENGTH,
    TIME,
    WALL,
)
from lta_analysis.report.results import phases_of
from lta_analysis.report.view import sampled, View
from lta_sim.light_field import direct
from lta_sim.scenario import Scenario
import numpy as np
from plotly.graph_objects import Contour, Figure, Scatter

RAY = 0.75  # m; long enough to see a direction, short enough not to hide the next
RAY_PERIOD = 1.0  # s
BEADS = 700
MARGIN = 0.25  # m of paper around the room


def picture(view: View) -> Figure:
    """Return the true path in the room, with the lamp's light and the measured bearings."""
    figure = blank()
    figure.update_layout(hovermode='closest', margin={'l': 40, 'r': 12, 't': 12, 'b': 40})
    scenario = view.scene.scenario
    if scenario is not None:
        figure.add_trace(glow(view, scenario))
        furnish(figure, scenario)
    if view.has('light/bearing', 'light/peaks'):
        for ray in rays(view):
            figure.add_trace(ray)
    if view.has('odom'):
        estimate = view.estimate
        keep = slice(None, None, max(1, len(estimate.time) // BEADS))
        figure.add_trace(
            Scatter(
                x=estimate.x[keep].astype(np.float32), y=estimate.y[keep].astype(np.float32),
                mode='lines', line={'color': ESTIMATE, 'width': 1.2, 'dash': 'dot'},
                name='dead reckoning', hoverinfo='skip',
            )
        )  # fmt: skip
        name(figure, float(estimate.x[-1]), float(estimate.y[-1]), 'dead reckoning', ESTIMATE, -12)
    figure.add_trace(beads(view))
    clock(figure, view)
    frame(figure, view)
    return figure


def name(figure: Figure, x: float, y: float, text: str, colour: str, shift: float) -> None:
    """Write a word at a place, `shift` px above it."""
    figure.add_annotation(x=x, y=y, yshift=shift, text=text, font={'color': colour, 'size': 11})


def frame(figure: Figure, view: View) -> None:
    """Show the whole room, or the whole path where there is none, one metre as long as another."""
    if view.scene.scenario is not None:
        length, width, _ = view.scene.scenario.room.size.vector
        corners = (-length / 2, length / 2, -width / 2, width / 2)
    else:
        truth = view.truth
        corners = (truth.x.min(), truth.x.max(), truth.y.min(), truth.y.max())
    left, right, low, high = corners
    figure.update_xaxes(
        range=[left - MARGIN, right + MARGIN], title_text='x [m]', showgrid=False, dtick=1,
        constrain='domain',
    )  # fmt: skip
    figure.update_yaxes(
        range=[low - MARGIN, high + MARGIN], title_text='y [m]', showgrid=False, dtick=1,
        scaleanchor='x', constrain='domain',
    )  # fmt: skip


def glow(view: View, scenario: Scenario) -> Contour:
    """Return the lamp's direct light at cruising height, a shade for each factor of two."""
    length, width, _ = scenario.room.size.vector
    x, y = np.linspace(-length / 2, length / 2, 121), np.linspace(-width / 2, width / 2, 97)
    height = float(np.median(view.truth.z)) if view.has('ground_truth/odom') else 0.5
    points = np.stack([*np.meshgrid(x, y), np.full((len(y), len(x)), height)], axis=-1)
    towards = np.array(scenario.lamp.position.vector) - points
    towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
    octaves = np.log2(np.maximum(direct(scenario.light_field.lamp, points, towards), 1.0))
    return Contour(
        x=x.astype(np.float32), y=y.astype(np.float32), z=octaves.astype(np.float32),
        colorscale=scale(GLOW), showscale=False, hoverinfo='skip', name='light of the lamp',
        contours={'start': 4, 'end': 12, 'size': 1, 'coloring': 'fill'}, line={'width': 0},
        zmin=3, zmax=12,
    )  # fmt: skip


def furnish(figure: Figure, scenario: Scenario) -> None:
    """Draw walls, lamp, goal and start."""
    length, width, _ = scenario.room.size.vector
    x, y, _ = scenario.lamp.position.vector
    radius = scenario.goal.radius.si
    facing = np.arctan2(scenario.lamp.facing.vector[1], scenario.lamp.facing.vector[0])
    half = {'x0': -length / 2, 'x1': length / 2, 'y0': -width / 2, 'y1': width / 2}
    figure.add_shape(type='rect', **half, line={'color': WALL, 'width': 3}, layer='below')
    figure.add_shape(
        type='circle', x0=x - radius, x1=x + radius, y0=y - radius, y1=y + radius,
        line={'color': GOOD, 'width': 1.5, 'dash': 'dash'},
    )  # fmt: skip
    figure.add_trace(
        Scatter(
            x=[x], y=[y], mode='markers', name='lamp',
            marker={
                'symbol': 'triangle-up', 'size': 15, 'color': LAMP,
                'angle': 90.0 - float(np.degrees(facing)), 'line': {'color': PAPER, 'width': 1.5},
            },
            hovertemplate=f'lamp, {scenario.lamp.frequency.si:g} Hz<extra></extra>',
        )
    )  # fmt: skip
    figure.add_annotation(
        x=x, y=y, xshift=12, xanchor='left', text=f'lamp<br>{scenario.lamp.frequency.si:g} Hz',
        align='left', font={'color': LAMP, 'size': 12},
    )  # fmt: skip
    name(figure, x, y - radius, f'goal: within {radius:g} m', GOOD, -10)
    start = scenario.start.position.vector
    figure.add_trace(
        Scatter(
            x=[start[0]], y=[start[1]], mode='markers', name='start', hoverinfo='skip',
            marker={'symbol': 'circle-open', 'size': 11, 'color': INK, 'line': {'width': 1.5}},
        )
    )  # fmt: skip
    name(figure, start[0], start[1], 'start', INK, -16)


def beads(view: View) -> Scatter:
    """Return the true path as a ribbon that is coloured by time."""
    truth = view.truth
    keep = slice(None, None, max(1, len(truth.time) // BEADS))
    time = truth.time[keep]
    return Scatter(
        x=truth.x[keep].astype(np.float32), y=truth.y[keep].astype(np.float32), mode='markers',
        name='path', customdata=np.stack([time, truth.z[keep]], axis=1).astype(np.float32),
        marker={'color': time.astype(np.float32), 'colorscale': scale(TIME), 'size': 4.5},
        hovertemplate='%{customdata[0]:.1f} s<br>x %{x:.2f} m, y %{y:.2f} m, '
        'z %{customdata[1]:.2f} m<extra></extra>',
    )  # fmt: skip


def clock(figure: Figure, view: View) -> None:
    """Write the time beside the path, every few seconds while it moves."""
    phases = phases_of(view)
    start = phases.search if np.isfinite(phases.search) else view.span[0]
    step = next(s for s in (2, 5, 10, 20, 60, 600) if (phases.end - start) / s <= 8 or s == 600)
    truth = view.truth
    for time in np.arange(np.ceil(start / step) * step, phases.end, step):
        x, y = (float(np.interp(time, truth.time, part)) for part in (truth.x, truth.y))
        name(figure, x, y, f'{time:g} s', SOFT, 14)


def rays(view: View) -> list[Scatter]:
    """Return the measured bearings, one a second, coloured by the SNR of the best diode."""
    time, angle = view.bearing
    phases = phases_of(view)
    start = phases.search if np.isfinite(phases.search) else view.span[0]
    moments = np.arange(start, phases.end, RAY_PERIOD)
    chosen = np.unique(np.searchsorted(time, moments).clip(0, len(time) - 1))
    chosen = chosen[np.isfinite(angle[chosen])]
    truth = view.truth
    x, y, yaw = (sampled(time, truth.time, part) for part in (truth.x, truth.y, truth.yaw))
    peak_time, parts = view.peaks
    snr = np.log10(np.maximum(sampled(time, peak_time, parts['snr'].max(axis=1)), 1.0))
    course = yaw + angle
    return [ray(x[k], y[k], course[k], shade(snr[k])) for k in chosen]


def ray(x: float, y: float, course: float, colour: str) -> Scatter:
    """Return one bearing."""
    return Scatter(
        x=[x, x + RAY * np.cos(course)], y=[y, y + RAY * np.sin(course)], mode='lines',
        line={'color': colour, 'width': 1.6}, hoverinfo='skip', name='bearing',
    )  # fmt: skip


def shade(decades: float) -> str:
    """Return the colour of an SNR: below 3, 30, 300, and beyond."""
    return STRENGTH[int(np.clip(np.floor(decades - 0.477 + 1.0), 0, len(STRENGTH) - 1))]
