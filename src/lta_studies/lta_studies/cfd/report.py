# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a wind-tunnel sweep: drag of the vehicle, and its rotors' net wrenches."""

from collections.abc import Sequence
import json
import math
from typing import Final

from lta_report.charts import ChartAxis, Curve, draw_curves, item_colour
from lta_report.drawing import create_figure
from lta_report.formatting import Tile
from lta_report.palette import HEAT, WALL
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_windtunnel.aero_fit import (
    ALONG,
    collect_warnings,
    compare_inclined_flows,
    fit_drag_by_axis,
    hull_share,
    mesh_share,
    middle_speed_point,
    opposing_drag,
    ratio_to_estimate,
    select_fit_points,
    select_solved_points,
    sum_processor_time,
    TURN_AXIS,
)
from lta_windtunnel.aero_text import format_aero_file
from lta_windtunnel.flow_fields import FlowSlice
from lta_windtunnel.flow_plan import MIDDLE_SPEED, SLOW_SPEED
from lta_windtunnel.sweep_table import AXES, Axis, drop_pressure_maps, format_sweep, TunnelSweep
from lta_windtunnel.thrust_allocation import linearity_ratio, sum_columns
from lta_windtunnel.tunnel import MAX_LAMINAR_REYNOLDS
import numpy as np
from plotly.graph_objects import Figure, Heatmap


def draw_drag(sweep: TunnelSweep, turning: bool) -> Figure:
    """Plot drag along, or moment about, three axes: points, fit and analytic estimate."""
    curves = []
    axes = [axis for axis in AXES if (axis in TURN_AXIS) == turning]
    fits = fit_drag_by_axis(sweep)
    for k, axis in enumerate(axes):
        colour, hand = item_colour(k), sweep.by_hand[axis]
        points = select_solved_points(sweep, axis)
        # With points, theirs name the colour
        named = {'showlegend': not points}
        curves.append(
            Curve(
                f'{axis}, analytic', [p.speed for p in hand], opposing_drag(axis, hand), colour,
                dash='dot', width=1.0, more=named,
            )
        )  # fmt: skip
        if not points:
            continue
        speeds = np.geomspace(hand[0].speed, hand[-1].speed, 60).tolist()
        drag = [fits[axis].drag_at(u) for u in speeds]
        quiet = {'hoverinfo': 'skip', 'showlegend': False}
        curves.append(Curve(f'{axis}, fit', speeds, drag, colour, '', width=1.8, more=quiet))
        values = opposing_drag(axis, points)
        # The spread is relative to the value.
        spread = [p.evidence.spread * v for p, v in zip(points, values, strict=True)]
        curves.append(Curve(axis, [p.speed for p in points], values, colour, mode='markers',
                            above=spread))  # fmt: skip
    title, drag_title, ticks = (
        ('rate [rad/s]', 'moment [N m]', (0.3, 1.0, 3.0)) if turning
        else ('speed [m/s]', 'drag [N]', (0.2, 0.5, 1.0, 1.5, 2.0))
    )  # fmt: skip
    power = {'exponentformat': 'power', 'dtick': 1}
    return draw_curves(
        curves,
        ChartAxis(title, log=True, ticks=ticks),
        ChartAxis(drag_title, log=True, more=power),
    )


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


def build_drag_table(sweep: TunnelSweep) -> TextTable:
    """Return the table of linear and quadratic drag of each axis, with quality measures."""
    rows = []
    for axis, fit in fit_drag_by_axis(sweep).items():
        points = select_fit_points(sweep, axis)
        middle = middle_speed_point(sweep, axis)
        rows.append([
            axis, f'{fit.linear:.2g}', f'{fit.quadratic:.3g}', f'{100 * fit.error:.1f}',
            '' if math.isnan(fit.exponent) else f'{fit.exponent:.2f}',
            f'{100 * max(p.evidence.spread for p in points):.1f}',
            f'{middle.evidence.cells}' if select_solved_points(sweep, axis) else 'estimate',
            _format_percent(mesh_share(sweep, axis), '+.0f'),
            _format_percent(hull_share(sweep, axis), '.0f'),
            f'{ratio_to_estimate(sweep, axis):.2f}',
        ])  # fmt: skip
    heads = [
        'axis', 'D1', 'D2', 'fit error [%]', 'exponent', 'spread [%]', 'cells', 'mesh [%]',
        'hull [%]', 'ratio to estimate',
    ]  # fmt: skip
    note = (
        'D1 (linear drag) in N s/m and N m s, D2 (quadratic drag) in N s2/m2 and N m s2, '
        'about the hull centre. Fit error: at the worst point. At the middle speed: mesh, '
        'additional drag on a coarser mesh; hull, share of the hull in the drag; ratio to '
        'estimate, drag divided by the analytic estimate.'
    )
    return TextTable('Drag', heads, rows, note)


def _format_percent(share: float | None, form: str) -> str:
    return '' if share is None else f'{100 * share:{form}}'


def _format_thousandths(value: float, digits: int) -> str:
    return f'{round(1e3 * value, digits) + 0.0:.{digits}f}'  # + 0.0 turns -0.0 into 0.0


def build_rotor_table(sweep: TunnelSweep) -> TextTable:
    """Return the table of net wrenches, compared with the sum of single rotors."""
    rows = []
    for name, blown in sweep.blows.items():
        sum_ = sum_columns(sweep, blown.shares)
        share = linearity_ratio(sweep, name)
        rows.append([
            name.replace('_', ' '), *(_format_thousandths(each, 0) for each in blown.force),
            *(_format_thousandths(each, 1) for each in blown.moment),
            '' if sum_ is None or len(blown.shares) < 2 else _format_thousandths(sum_[2], 0),
            '' if share is None else f'{share:.3f}',
            f'{100 * (blown.evidence.balance or 0.0):.2f}',
        ])  # fmt: skip
    heads = [
        'rotors', 'Fx [mN]', 'Fy', 'Fz', 'Mx [mN m]', 'My', 'Mz', 'Fz of sum', 'quarter',
        'balance [%]',
    ]  # fmt: skip
    note = (
        'Net force and moment about the hull centre, including the thrust. Fz of sum: the '
        'sum of the rotors running one at a time. Quarter: force at a quarter of the thrust '
        'divided by a quarter of the force at full thrust; 1 if linear. Balance: difference '
        'between the force and the momentum of the air, relative to the force.'
    )
    return TextTable('Rotors on', heads, rows, note)


def build_incidence_table(sweep: TunnelSweep) -> TextTable:
    """Return the table of forward flight with the nose up, beside what the model flies."""
    rows = [
        [
            f'{flow.incidence:.0f}',
            _format_thousandths(flow.point.force[0], 1),
            _format_thousandths(flow.by_axis[0], 1),
            _format_thousandths(flow.point.force[2], 1),
            _format_thousandths(flow.by_axis[1], 1),
            f'{flow.lift_slope:.2f}',
            _format_thousandths(flow.point.moment[1], 2),
            _format_thousandths(flow.munk, 2),
            f'{flow.lost:.2f}',
            f'{100 * flow.point.evidence.spread:.1f}',
        ]
        for flow in compare_inclined_flows(sweep)
    ]
    heads = [
        'incidence [deg]', 'Fx [mN]', 'by axis', 'Fz [mN]', 'by axis', 'lift slope', 'My [mN m]',
        'Munk', 'lost', 'spread [%]',
    ]  # fmt: skip
    note = (
        'Force and moment in body axes about the hull centre at 1 m/s, with the nose up by the '
        'incidence; a negative My raises it further. By axis: the drag of surge and heave, each '
        'at its part of the speed. Lift slope: the force Fz beyond that, as a coefficient by '
        'radian on the shadow of the hull from above; the effect oblique_lift has it as '
        'lift and stall. Munk: the moment of attached flow. Lost: the share of it that is '
        'missing, the value of the effect munk_moment. Spread: of the drag.'
    )
    return TextTable('Nose up', heads, rows, note)


INTRODUCTION: Final = (
    'Drag of the vehicle along and about its three axes, and the net force of each rotor '
    'including its jet on the hull. A flow solver computes both from the shape, without '
    'flights.'
)
DRAG_CAPTION: Final = (
    'Points: drag from the flow solver, with its variation over the averaging window. '
    'Lines: the fit that flight simulations use. Dotted: analytic estimate, which should '
    'agree within a factor of two.'
)
TUNNEL_METHOD: Final = (
    'Each direction has one mesh. The air always moves at 1 m/s; to get the Reynolds number '
    'of another speed, the viscosity is divided by that speed. Fidelity preview: steady '
    'k-omega SST with transition, on a half or a quarter of the domain where the vehicle is '
    f'symmetric. Fidelity reference: transient at {MIDDLE_SPEED:g} m/s in the whole tunnel, with '
    f'implicit LES, or DES above a Reynolds number of {MAX_LAMINAR_REYNOLDS:,.0f}; steady at '
    f'{SLOW_SPEED:g} m/s.',
    'Each rotor is a momentum source in its disk, without swirl. Rotation of the vehicle is '
    'computed as steady, in a rotating frame: the damping of small fast oscillations is '
    'underestimated.',
    'A result is rejected if a rotor disk has fewer than 30 cells, if the force still '
    'varies by more than 15 %, or if the momentum of the air differs from the force by more '
    'than 10 %. The results are not grid-converged.',
)
SLICE_CAPTION: Final = 'Airspeed in the middle plane. Grey: solid parts.'


def build_report(sweep: TunnelSweep, slices: Sequence[FlowSlice]) -> Report:
    """Return the report of a sweep."""
    warnings = [f'Warning: {each}.' for each in collect_warnings(sweep)]
    # Pressure maps are large; only the blown file contains them
    small = format_sweep(drop_pressure_maps(sweep))
    outputs = {f'{sweep.name}.aero.yaml': format_aero_file(sweep)}
    if sweep.blows:
        outputs[f'{sweep.name}.blown.json'] = format_sweep(sweep)
    return Report(
        command='cfd run',
        subject=sweep.name,
        headline=format_headline(sweep),
        introduction=INTRODUCTION,
        tiles=build_tiles(sweep),
        blocks=(
            Picture('along', 'Moving', DRAG_CAPTION, draw_drag(sweep, turning=False)),
            Picture('about', 'Turning', DRAG_CAPTION, draw_drag(sweep, turning=True)),
            *(
                Picture(
                    f'slice-{each.about}', format_slice_heading(each), SLICE_CAPTION,
                    draw_slice(each)
                )
                for each in slices
            ),
            build_drag_table(sweep),
            *([build_incidence_table(sweep)] if sweep.inclined else []),
            *([build_rotor_table(sweep)] if sweep.blows else []),
            TextSection('Meaning and method', (*warnings, *TUNNEL_METHOD)),
        ),
        data=json.loads(small),
        facts={
            'engine': sweep.engine, 'fidelity': sweep.fidelity, 'geometry': sweep.geometry,
            'processor time': f'{sum_processor_time(sweep) / 60.0:.1f} min, without meshing',
        },
        json_name=f'{sweep.name}.sweep.json',
        outputs=outputs,
        # Without any solved flow, the files still contain the analytic part
        status=1 if sweep.refused and not (sweep.axes or sweep.inclined or sweep.blows) else 0,
    )  # fmt: skip


def format_slice_heading(plane: FlowSlice) -> str:
    """Return the heading of a slice."""
    return f'{plane.about.replace("_", " ").capitalize()}: airspeed in the middle plane'


def format_headline(sweep: TunnelSweep) -> str:
    """Return the headline."""
    fits = fit_drag_by_axis(sweep)
    failed = len(sweep.refused)
    count = failed + len(sweep.blows) + len(sweep.coarse) + len(sweep.inclined)
    count += sum(map(len, sweep.axes.values()))
    lost = f', {failed} of {count} results failed' if failed else ''
    return (
        f'{sweep.name} has a drag of {fits["surge"].drag_at(1.0):.3f} N in forward flight '
        f'and {fits["heave"].drag_at(1.0):.3f} N in vertical flight at 1 m/s '
        f'({sweep.fidelity}{lost}).'
    )


def build_tiles(sweep: TunnelSweep) -> list[Tile]:
    """Return tiles with the drag of each axis at 1 m/s or 1 rad/s, and the lift of all rotors."""
    fits = fit_drag_by_axis(sweep)
    tiles = [
        Tile(axis, f'{1e3 * fits[axis].drag_at(1.0):.0f}', 'mN',
             f'drag at 1 m/s, {_describe_source(sweep, axis)}')
        for axis in ALONG
    ]  # fmt: skip
    tiles += [
        Tile(axis, f'{1e3 * fits[axis].drag_at(1.0):.2f}', 'mN m',
             f'drag at 1 rad/s, {_describe_source(sweep, axis)}')
        for axis in TURN_AXIS
    ]  # fmt: skip
    # A vehicle without rotors has no such flow.
    if (blown := sweep.blows.get('all')) is not None:
        tiles.append(Tile('all rotors on', f'{blown.force[2]:.3f}', 'N', 'net, upwards'))
    return tiles


def _describe_source(sweep: TunnelSweep, axis: Axis) -> str:
    return 'from the flow solver' if select_solved_points(sweep, axis) else 'analytic estimate'
