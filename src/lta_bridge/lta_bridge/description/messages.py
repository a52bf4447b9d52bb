"""
Messages that describe a drone and its scene once: URDF, fixed frames, room.

The description node publishes them, and a flight in one process records them.
"""

from collections.abc import Iterator
from typing import Any

from builtin_interfaces.msg import Time
from lta_bridge.live.messages import build_marker_array
from lta_bridge.live.room_shapes import draw_static_scene
from lta_bridge.urdf import build_urdf, list_fixed_frames
from lta_graph.ros.transforms import build_transform
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage


def iterate_descriptions(vehicle: Vehicle, scenario: Scenario | None) -> Iterator[tuple[str, Any]]:
    """
    Yield topic and message of each description.

    `vehicle`: the drone. `scenario`: the room of a simulated drone; None for a real one, whose
    place in it is not known.
    """
    yield 'robot_description', String(data=build_urdf(vehicle))
    if scenario is not None:
        yield 'scene', build_marker_array(draw_static_scene(scenario))
    # Fixed frames hold at all times, so their stamp is zero
    fixed = [
        build_transform(Time(), (frame.parent, frame.name), frame.place, frame.turn)
        for frame in list_fixed_frames(vehicle)
    ]
    yield '/tf_static', TFMessage(transforms=fixed)
