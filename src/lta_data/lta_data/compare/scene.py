"""The 3-D view of a comparison: both flights as ghosts, at the same time on A's clock."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_bridge.description.scene import draw_static_scene
from lta_config.errors import BadInput
from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.channel_roles import find_pose_prefix
from lta_data.compare.comparison import ComparisonResult
from lta_data.compare.sampling import interpolate_signal, wrap_angle
from lta_data.scene import read_scene, RecordedScene
from lta_model.attitude import EulerAngles, to_quaternions
from lta_report.flight_scene import (
    build_scene_track,
    draw_vehicle,
    render_scene,
    sample_times,
    SceneFlight,
    SceneSet,
    to_json_numbers,
)
from lta_report.palette import ESTIMATE, TRUTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MAP_POSE: Final = 'ground_truth/odom/'  # the only pose in the frame of the room
PLACE: Final = tuple(f'position.{axis}' for axis in 'xyz')
ANGLES: Final = ('orientation.yaw', 'orientation.pitch', 'orientation.roll')
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
    angles = [by_name.get(f'{pose}{field}') for field in ANGLES]
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
    turned = np.degrees(wrap_angle(turn_b.yaw - turn_a.yaw))
    columns = {
        'apart': to_json_numbers(np.linalg.norm(place_b - place_a, axis=1)),
        'turned': to_json_numbers(turned),
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
    """Return positions, shape (n, 3), and attitudes; unknown angles are zero. [m]"""
    place = [interpolate_signal(getattr(each, side), time) for each in places]
    turn = [
        np.zeros_like(time)
        if each is None
        else np.nan_to_num(interpolate_signal(getattr(each, side), time, angular=True))
        for each in angles
    ]
    return np.stack(place, axis=1), EulerAngles(*turn)
