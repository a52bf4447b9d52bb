# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plot the channels of both flights, reduced to what a screen can show."""

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

from lta_config.constants import DEGREES_PER_RADIAN
from lta_config.errors import BadInput
from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.channel_roles import find_pose_prefix
from lta_data.compare.comparison import ComparisonResult
from lta_data.compare.sampling import (
    align_signals,
    break_at_gaps,
    interpolate_signal,
    wrap_angle,
)
from lta_data.even_grid import SampledSignal
from lta_data.scene import read_scene, RecordedScene
from lta_model.attitude import EulerAngles, to_quaternions
from lta_model.drawing.scene import draw_static_scene
from lta_report.drawing import create_figure, decimate_line, padded_range
from lta_report.flight_scene import (
    build_scene_track,
    draw_vehicle,
    render_scene,
    sample_times,
    SceneFlight,
    SceneSet,
    to_json_numbers,
)
from lta_report.palette import ESTIMATE, FILL, SETPOINT, SOFT, TRUTH, WALL
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure, Scatter

FIGURE_POINTS: Final = 1200  # per line; a plot is at most about that wide in pixels


class ChannelTrace(NamedTuple):
    """A channel as drawn: its unit, A, B, the difference, and the band."""

    unit: str
    a: SampledSignal
    b: SampledSignal
    difference: SampledSignal
    band: float


def build_channel_trace(each: ChannelComparison) -> ChannelTrace:
    """Return a channel as drawn: angles in degrees and unwrapped."""
    unit, factor = each.unit, 1.0
    if unit in ('rad', 'rad/s'):
        unit, factor = unit.replace('rad', '°'), DEGREES_PER_RADIAN
    if each.angular:
        a, b = unwrap_pair(each)
    else:
        a, b = break_at_gaps(each.a), break_at_gaps(each.b)
    lines = [a, b, break_at_gaps(SampledSignal(each.both.time, each.both.difference))]
    one, other, apart = (
        SampledSignal(*decimate_line(line.time, factor * line.values, FIGURE_POINTS))
        for line in lines
    )
    return ChannelTrace(unit, one, other, apart, factor * each.parting.band)


def unwrap_pair(each: ChannelComparison) -> tuple[SampledSignal, SampledSignal]:
    """Unwrap both angles at their common times, B near A."""
    time, difference = each.both.time, each.both.difference
    finite = np.isfinite(each.both.a)
    a = np.full(len(time), np.nan)
    a[finite] = np.unwrap(each.both.a[finite])
    return break_at_gaps(SampledSignal(time, a)), break_at_gaps(
        SampledSignal(time, a + difference)
    )


A, B, DIFFERENCE = TRUTH, ESTIMATE, SETPOINT
WIDE, NARROW = 3.0, 1.2  # px: A stays visible behind B where they agree


def plot_overlay(each: ChannelComparison, time: tuple[float, float]) -> Figure:
    """Plot A and B above their difference, with band and divergence."""
    trace = build_channel_trace(each)
    figure = create_figure(2, [0.66, 0.34])
    for line, name, colour, width, row in (
        (trace.a, 'A', A, WIDE, 1), (trace.b, 'B', B, NARROW, 1),
        (trace.difference, 'B - A', DIFFERENCE, NARROW, 2),
    ):  # fmt: skip
        figure.add_trace(
            Scatter(
                x=line.time, y=line.values, name=name,
                mode='lines', line={'color': colour, 'width': width}, connectgaps=False,
                hovertemplate=f'%{{y:.4~g}} {trace.unit}',
            ),
            row=row, col=1,
        )  # fmt: skip
    figure.add_shape(
        type='rect', xref='x2 domain', x0=0, x1=1, yref='y2', y0=-trace.band, y1=trace.band,
        fillcolor=FILL, line={'width': 0}, layer='below',
    )  # fmt: skip
    at = each.parting.at
    if at is not None:
        figure.add_shape(
            type='line', xref='x', x0=at, x1=at, yref='paper', y0=0, y1=1, layer='below',
            line={'color': WALL, 'width': 1, 'dash': '2px,3px'},
        )  # fmt: skip
        figure.add_annotation(
            x=at, xref='x', y=1.0, yref='paper', yanchor='bottom', text='they diverge',
            xanchor='left', font={'size': 10, 'color': SOFT},
        )  # fmt: skip
    unit = f' [{trace.unit}]' if trace.unit not in ('', '1') else ''
    figure.update_xaxes(range=list(time), hoverformat='.2f', unifiedhovertitle_text='%{x} s')
    figure.update_xaxes(title_text="time on A's clock [s]", row=2)
    figure.update_yaxes(title_text=f'A, B{unit}', row=1)
    figure.update_yaxes(title_text=f'B - A{unit}', row=2)
    return figure.update_layout(margin={'r': 20, 'l': 66})


def plot_path(channels: Sequence[ChannelComparison]) -> Figure | None:
    """Plot both paths from above in A's frame; None without positions."""
    pose = find_pose_prefix(channels)
    by_name = {each.name: each for each in channels}
    both = by_name.get(f'{pose}position.x'), by_name.get(f'{pose}position.y')
    if both[0] is None or both[1] is None:
        return None
    figure = create_figure()
    ends = []
    for name, colour, width in (('A', A, WIDE), ('B', B, NARROW)):
        x, y = (getattr(each, name.lower()) for each in both)
        joined = align_signals(x, y)
        across, along = thin_path(joined.time, joined.a, joined.b)
        figure.add_trace(
            Scatter(
                x=across, y=along, name=name, mode='lines', line={'color': colour, 'width': width},
                hovertemplate='%{x:.2f}, %{y:.2f} m',
            )
        )  # fmt: skip
        finite = np.flatnonzero(np.isfinite(across) & np.isfinite(along))
        if len(finite):
            ends.append((across[finite[[0, -1]]], along[finite[[0, -1]]], colour, name))
    for across, along, colour, name in ends:
        figure.add_trace(
            Scatter(
                x=across, y=along, mode='markers', name=f'start and end of {name}',
                marker={'color': ['rgba(0,0,0,0)', colour], 'size': 9,
                        'line': {'color': colour, 'width': 2}},
                hovertemplate=[f'{name} starts', f'{name} ends'],
            )
        )  # fmt: skip
    seen = [trace for trace in figure.data if trace.mode == 'lines']
    # Both axes at one scale, or the shape of the path would be distorted
    wide, high = (padded_range(*(np.asarray(line[axis]) for line in seen)) for axis in 'xy')
    figure.update_layout(hovermode='closest', margin={'r': 24, 'l': 66})
    figure.update_xaxes(title_text="x in A's frame [m]", range=wide, constrain='domain')
    return figure.update_yaxes(title_text="y in A's frame [m]", range=high, scaleanchor='x')


def thin_path(time: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Thin a path evenly, keeping its gaps."""
    across, along = (break_at_gaps(SampledSignal(time, values)).values for values in (x, y))
    even = np.arange(0, len(across), -(-len(across) // FIGURE_POINTS) or 1)
    keep = np.union1d(even, np.flatnonzero(np.isnan(across + along)))
    return across[keep].astype(np.float32), along[keep].astype(np.float32)


Array = NDArray[np.float64]
MAP_POSE: Final = 'ground_truth/odom/'  # the only pose in the frame of the room
PLACE: Final = tuple(f'position.{axis}' for axis in 'xyz')
ANGLE_FIELDS: Final = ('orientation.yaw', 'orientation.pitch', 'orientation.roll')
CAPTION: Final = (
    "Both flights at the same time on A's clock, in A's frame. The path ahead is pale; a flight "
    'is hidden while its position is unknown.'
)
READOUT: Final = {
    'time': ('time', '\N{NO-BREAK SPACE}s', 1, 1.0),
    'apart': ('apart', '\N{NO-BREAK SPACE}m', 2, 1.0),
    'turned': ('heading, B - A', '°', 0, 1.0),
}


def render_comparison_scene(
    comparison: ComparisonResult, span: tuple[float, float]
) -> tuple[str, Mapping[str, object]]:
    """
    Return the panel of the 3-D view and the track of the page; both empty without positions.

    `span`: time that the view covers, on A's clock [s].
    """
    pose = find_pose_prefix(comparison.channels)
    by_name = {each.name: each for each in comparison.channels}
    places = [by_name.get(f'{pose}{field}') for field in PLACE]
    channels = [each for each in places if each is not None]
    if not pose or len(channels) < len(PLACE):
        return '', {}
    angles = [by_name.get(f'{pose}{field}') for field in ANGLE_FIELDS]
    time = sample_times(*span)
    poses = {side: sample_pose(channels, angles, side, time) for side in ('a', 'b')}
    scene = read_recorded_scene(comparison)
    body, reach, _ = draw_vehicle(scene.vehicle)
    flights = [
        SceneFlight(name, colour, body, position, to_quaternions(turn), ghost=True)
        for name, colour, (position, turn) in (
            ('A', TRUTH, poses['a']),
            ('B', ESTIMATE, poses['b']),
        )
    ]
    (place_a, turn_a), (place_b, turn_b) = poses['a'], poses['b']
    apart = np.linalg.norm(place_b - place_a, axis=1)
    turned = np.degrees(wrap_angle(turn_b.yaw - turn_a.yaw))
    columns = {
        'apart': to_json_numbers(apart),
        # Unknown where one of them is hidden
        'turned': to_json_numbers(np.where(np.isfinite(apart), turned, np.nan)),
    }
    room = scene.scenario if pose.startswith(MAP_POSE) else None
    scene_set = SceneSet(time, flights, columns)
    panel = render_scene(
        [scene_set], [] if room is None else draw_static_scene(room), CAPTION, reach
    )
    return panel, build_scene_track(scene_set)


def read_recorded_scene(comparison: ComparisonResult) -> RecordedScene:
    """Return the scene of A; empty if it cannot be read."""
    try:
        return read_scene(comparison.a.provenance)
    except BadInput:  # written by another version, which does not matter for a comparison
        return RecordedScene(None, None)


def sample_pose(
    places: Sequence[ChannelComparison],
    angles: Sequence[ChannelComparison | None],
    side: str,
    time: Array,
) -> tuple[Array, EulerAngles]:
    """Return positions, shape (n, 3), and attitudes; unknown angles are zero [m]."""
    place = [interpolate_signal(getattr(each, side), time) for each in places]
    turn = [
        np.zeros_like(time)
        if each is None
        else np.nan_to_num(interpolate_signal(getattr(each, side), time, angular=True))
        for each in angles
    ]
    return np.stack(place, axis=1), EulerAngles(*turn)
