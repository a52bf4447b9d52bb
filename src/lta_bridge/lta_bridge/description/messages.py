# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Messages that describe a drone and its scene once: URDF, fixed frames, and markers of the room.

The description node publishes them, and a flight in one process records them.
"""

from collections.abc import Iterable, Iterator
import math
from typing import Any, Final

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
from lta_bridge.description.urdf import build_urdf, list_fixed_frames
from lta_graph.ros.transforms import build_transform
from lta_model.drawing.scene import draw_static_scene
from lta_model.drawing.shapes import (
    BillboardText,
    BoxShape,
    CylinderShape,
    EllipsoidShape,
    NO_SHIFT,
    NO_TURN,
    PolylineShape,
    Shape,
    ShapeEntity,
    Three,
    Turn,
)
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from std_msgs.msg import ColorRGBA, String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

CONE_SIDES: Final = 24  # of a cone
ONES: Final[Three] = (1.0, 1.0, 1.0)


def build_marker_array(entities: Iterable[ShapeEntity]) -> MarkerArray:
    """Return the markers of shapes; those of one entity share its name as namespace."""
    markers = []
    for entity in entities:
        for number, shape in enumerate(entity.shapes):
            marker = build_marker(shape)
            marker.header.frame_id, marker.ns, marker.id = entity.frame, entity.name, number
            marker.frame_locked = True
            markers.append(marker)
    return MarkerArray(markers=markers)


def build_marker(shape: Shape) -> Marker:
    """Return the marker of one shape."""
    match shape:
        case EllipsoidShape():
            marker = place_marker(Marker.SPHERE, shape.place, shape.turn, shape.size)
        case BoxShape():
            marker = place_marker(Marker.CUBE, shape.place, shape.turn, shape.size)
        case CylinderShape(bottom=1.0, top=1.0):
            marker = place_marker(Marker.CYLINDER, shape.place, shape.turn, shape.size)
        case CylinderShape():
            # Markers have no cones
            marker = place_marker(Marker.TRIANGLE_LIST, shape.place, shape.turn, ONES)
            marker.points = [to_point(each) for each in list_cone_triangles(shape)]
        case PolylineShape():
            kind = Marker.LINE_LIST if shape.pairs else Marker.LINE_STRIP
            marker = place_marker(kind, NO_SHIFT, NO_TURN, (shape.thickness, 0.0, 0.0))
            marker.points = [to_point(each) for each in shape.points]
        case BillboardText():
            size = (0.0, 0.0, shape.height)
            marker = place_marker(Marker.TEXT_VIEW_FACING, shape.place, NO_TURN, size)
            marker.text = shape.text
    red, green, blue, opacity = shape.colour
    marker.color = ColorRGBA(r=red, g=green, b=blue, a=opacity)
    return marker


def place_marker(kind: int, place: Three, turn: Turn, size: Three) -> Marker:
    """Return a marker with its pose and size [m]."""
    marker = Marker(type=kind)
    marker.pose.position = to_point(place)
    rotation, scale = marker.pose.orientation, marker.scale
    rotation.x, rotation.y, rotation.z, rotation.w = turn
    scale.x, scale.y, scale.z = size
    return marker


def to_point(place: Three) -> Point:
    """Return a point as a message."""
    x, y, z = place
    return Point(x=x, y=y, z=z)


def list_cone_triangles(shape: CylinderShape) -> list[Three]:
    """Return the corners of the triangles of a cone's mantle, three each, on its own axes [m]."""
    (across, deep, high), corners = shape.size, []
    for side in range(CONE_SIDES):
        turns = [2.0 * math.pi * (side + k) / CONE_SIDES for k in (0, 1)]
        (a, b), (c, d) = (
            [
                (0.5 * scale * across * math.cos(turn), 0.5 * scale * deep * math.sin(turn), z)
                for turn in turns
            ]
            for scale, z in ((shape.bottom, -0.5 * high), (shape.top, 0.5 * high))
        )
        corners += [a, b, d, a, d, c]
    return corners


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
