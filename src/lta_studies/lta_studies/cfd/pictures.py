"""Plot a sweep: drag against speed with its fit, and slices through the flow."""

from collections.abc import Sequence
from itertools import cycle
from typing import Final

from lta_report.drawing import add_legend, create_figure
from lta_report.palette import ESTIMATE, GOOD, HEAT, LAMP, RAW, SETPOINT, TRUTH, WALL
from lta_windtunnel.aero_fit import ABOUT, fit_drag_by_axis, opposing_drag, select_solved_points
from lta_windtunnel.flow_fields import FlowSlice
from lta_windtunnel.sweep_table import AXES, TunnelSweep
from lta_windtunnel.validation import (
    morrison_drag_coefficient,
    SCATTER,
    SCATTER_RANGE,
    SphereComparison,
)
import numpy as np
from plotly.graph_objects import Figure, Heatmap, Scatter

COLOURS: Final = (TRUTH, ESTIMATE, GOOD)
SETTINGS: Final = (ESTIMATE, LAMP, GOOD, TRUTH, SETPOINT)


def draw_drag(sweep: TunnelSweep, turning: bool) -> Figure:
    """Plot drag along, or moment about, three axes: points, fit and analytic estimate."""
    figure = create_figure()
    axes = [axis for axis in AXES if (axis in ABOUT) == turning]
    fits = fit_drag_by_axis(sweep)
    for colour, axis in zip(COLOURS, axes, strict=True):
        hand = sweep.by_hand[axis]
        speeds = np.geomspace(hand[0].speed, hand[-1].speed, 60)
        points = select_solved_points(sweep, axis)
        figure.add_trace(
            Scatter(
                x=[p.speed for p in hand], y=opposing_drag(axis, hand), name=f'{axis}, analytic',
                mode='lines', line={'color': colour, 'width': 1, 'dash': 'dot'},
                # With points, theirs name the colour
                showlegend=not points,
            )
        )  # fmt: skip
        if not points:
            continue
        values = opposing_drag(axis, points)
        figure.add_trace(
            Scatter(
                x=speeds, y=[fits[axis].drag_at(float(u)) for u in speeds], name=f'{axis}, fit',
                mode='lines', line={'color': colour, 'width': 1.8}, hoverinfo='skip',
                showlegend=False,
            )
        )  # fmt: skip
        # The spread is relative to the value.
        spread = [p.evidence.spread * v for p, v in zip(points, values, strict=True)]
        figure.add_trace(
            Scatter(
                x=[p.speed for p in points], y=values, name=axis, mode='markers',
                marker={'color': colour, 'size': 8}, showlegend=True,
                error_y={'array': spread, 'color': colour, 'thickness': 1},
            )
        )  # fmt: skip
    unit = ('rate [rad/s]', 'moment [N m]') if turning else ('speed [m/s]', 'drag [N]')
    ticks = [0.3, 1.0, 3.0] if turning else [0.2, 0.5, 1.0, 1.5, 2.0]
    figure.update_xaxes(type='log', title_text=unit[0], tickvals=ticks)
    figure.update_yaxes(type='log', title_text=unit[1], dtick=1, exponentformat='power')
    add_legend(figure)
    return figure


def draw_slice(plane: FlowSlice) -> Figure:
    """Plot a slice through the flow."""
    figure = create_figure()
    top = float(np.nanpercentile(plane.speed, 99.7))  # ignores spikes at edges
    figure.add_trace(
        Heatmap(
            x=np.round(plane.across, 4).tolist(), y=np.round(plane.up, 4).tolist(),
            z=[[None if np.isnan(v) else round(float(v), 3) for v in row] for row in plane.speed],
            colorscale=[[k / (len(HEAT) - 1), each] for k, each in enumerate(HEAT)],
            zmin=0.0, zmax=top, colorbar={'title': {'text': 'm/s'}, 'thickness': 12},
            hovertemplate='%{x:.2f}, %{y:.2f} m: %{z:.2f} m/s<extra></extra>',
        )
    )  # fmt: skip
    bare = {'constrain': 'domain', 'showgrid': False}
    figure.update_xaxes(title_text=plane.names[0], **bare)
    figure.update_yaxes(title_text=plane.names[1], scaleanchor='x', **bare)
    # Cells without a value (solid) show the background.
    figure.update_layout(plot_bgcolor=WALL)
    return figure


def draw_sphere_drag(results: Sequence[SphereComparison]) -> Figure:
    """Plot the drag coefficient of the sphere, compared with measurements."""
    figure = create_figure()
    reynolds = np.geomspace(5e3, 3e5, 200)
    figure.add_trace(
        Scatter(
            x=[*SCATTER_RANGE, *SCATTER_RANGE[::-1]],
            y=[SCATTER[0], SCATTER[0], SCATTER[1], SCATTER[1]], fill='toself', mode='lines',
            line={'width': 0}, fillcolor='rgba(11,98,168,0.16)', name='Achenbach 1972',
            showlegend=True, hoverinfo='skip',
        )
    )  # fmt: skip
    figure.add_trace(
        Scatter(
            x=reynolds, y=[morrison_drag_coefficient(float(r)) for r in reynolds],
            name='Morrison 2013', mode='lines', line={'color': RAW, 'width': 2}, showlegend=True,
        )
    )  # fmt: skip
    settings = dict.fromkeys(each.setting for each in results)
    for colour, setting in zip(cycle(SETTINGS), settings, strict=False):
        those = [each for each in results if each.setting == setting]
        figure.add_trace(
            Scatter(
                x=[each.reynolds for each in those], y=[each.coefficient for each in those],
                name=setting, mode='markers+lines', line={'color': colour, 'width': 1},
                marker={'color': colour, 'size': 8}, showlegend=True,
                error_y={'array': [each.error * each.coefficient for each in those],
                         'color': colour},
            )
        )  # fmt: skip
    figure.update_xaxes(type='log', title_text='Reynolds number', exponentformat='power', dtick=1)
    figure.update_yaxes(title_text='drag coefficient', range=[0.2, 0.54])
    add_legend(figure)
    return figure
