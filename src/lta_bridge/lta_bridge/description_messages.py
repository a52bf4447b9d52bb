"""
Messages that describe a drone and its scene once: URDF, fixed frames, room.

The description node publishes them, and a flight in one process records them.
"""

from collections.abc import Iterator
import math
from typing import Any

from builtin_interfaces.msg import Time
from lta_bridge.live.frames import SceneFrame
from lta_bridge.live.messages import build_marker_array
from lta_bridge.live.room_shapes import draw_static_scene
from lta_bridge.urdf import build_urdf, list_fixed_frames
from lta_graph.ros.transforms import build_transform, MAP, TFMessage
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from std_msgs.msg import String

ODOM = 'odom'


def iterate_descriptions(
    vehicle: Vehicle, scenario: Scenario | None, prefix: str = ''
) -> Iterator[tuple[str, Any]]:
    """
    Yield topic and message of each description.

    Parameters
    ----------
    vehicle : Vehicle
        The drone.
    scenario : Scenario or None
        Where a simulated drone starts; None for a real one, whose place in the map is not known.
    prefix : str
        Prefix of the frames, such as 'lta1/', for several drones.

    """
    yield 'robot_description', String(data=build_urdf(vehicle))
    frames = list_fixed_frames(vehicle)
    if scenario is not None:
        yield 'scene', build_marker_array(draw_static_scene(scenario))
        frames.append(build_start_frame(scenario))
    # Fixed frames hold at all times, so their stamp is zero
    fixed = [
        build_transform(Time(), (frame.parent, frame.name), frame.place, frame.turn, prefix)
        for frame in frames
    ]
    yield '/tf_static', TFMessage(transforms=fixed)


def build_start_frame(scenario: Scenario) -> SceneFrame:
    """Return the frame of a simulated drone's odometry: on the floor below its start."""
    x, y = scenario.start.position.vector
    half = 0.5 * scenario.start.heading.si
    return SceneFrame(MAP, ODOM, (x, y, 0.0), (0.0, 0.0, math.sin(half), math.cos(half)))
