"""Encode shapes and frames as Foxglove messages."""

from collections.abc import Iterable

import foxglove.messages as fg
from lta_bridge.live.frames import SceneFrame
from lta_bridge.live.shapes import (
    ArrowShape,
    BillboardText,
    BoxShape,
    Colour,
    CylinderShape,
    EllipsoidShape,
    LEVEL,
    ORIGIN,
    PolylineShape,
    Shape,
    ShapeEntity,
    Three,
    Turn,
)

HEAD = 2.0  # ratio of an arrow's head width to its shaft
HEAD_SHARE = 0.25  # of an arrow's length


def encode_scene_update(entities: Iterable[ShapeEntity], stamp_ns: int) -> bytes:
    """Return entities as a serialised foxglove.SceneUpdate; each replaces that of its name."""
    return fg.SceneUpdate(entities=[_encode_entity(item, stamp_ns) for item in entities]).encode()


def encode_frame_transforms(frames: Iterable[SceneFrame], stamp_ns: int) -> bytes:
    """Return frames as serialised foxglove.FrameTransforms at a graph time. [ns]"""
    stamp = _encode_stamp(stamp_ns)
    return fg.FrameTransforms(
        transforms=[
            fg.FrameTransform(
                timestamp=stamp,
                parent_frame_id=frame.parent,
                child_frame_id=frame.name,
                translation=_encode_vector(frame.place),
                rotation=_encode_quaternion(frame.turn),
            )
            for frame in frames
        ]
    ).encode()


def _encode_entity(item: ShapeEntity, stamp_ns: int) -> fg.SceneEntity:
    shapes = item.shapes
    return fg.SceneEntity(
        timestamp=_encode_stamp(stamp_ns),
        frame_id=item.frame,
        id=item.name,
        # The viewer moves the shapes with their frame
        frame_locked=True,
        arrows=[_encode_arrow(s) for s in shapes if isinstance(s, ArrowShape)],
        cubes=[
            fg.CubePrimitive(
                pose=_encode_pose(s), size=_encode_vector(s.size), color=_encode_color(s.colour)
            )
            for s in shapes
            if isinstance(s, BoxShape)
        ],
        spheres=[
            fg.SpherePrimitive(
                pose=_encode_pose(s), size=_encode_vector(s.size), color=_encode_color(s.colour)
            )
            for s in shapes
            if isinstance(s, EllipsoidShape)
        ],
        cylinders=[_encode_cylinder(s) for s in shapes if isinstance(s, CylinderShape)],
        lines=[_encode_line(s) for s in shapes if isinstance(s, PolylineShape)],
        texts=[_encode_label(s) for s in shapes if isinstance(s, BillboardText)],
    )


def _encode_stamp(stamp_ns: int) -> fg.Timestamp:
    return fg.Timestamp(sec=stamp_ns // 1_000_000_000, nsec=stamp_ns % 1_000_000_000)


def _encode_vector(numbers: Three) -> fg.Vector3:
    x, y, z = numbers
    return fg.Vector3(x=x, y=y, z=z)


def _encode_quaternion(turn: Turn) -> fg.Quaternion:
    x, y, z, w = turn
    return fg.Quaternion(x=x, y=y, z=z, w=w)


def _encode_color(colour: Colour) -> fg.Color:
    r, g, b, a = colour
    return fg.Color(r=r, g=g, b=b, a=a)


def _encode_pose(shape: Shape) -> fg.Pose:
    # The points of a line carry its position already
    place = ORIGIN if isinstance(shape, PolylineShape) else shape.place
    turn = LEVEL if isinstance(shape, PolylineShape | BillboardText) else shape.turn
    return fg.Pose(position=_encode_vector(place), orientation=_encode_quaternion(turn))


def _encode_cylinder(shape: CylinderShape) -> fg.CylinderPrimitive:
    return fg.CylinderPrimitive(
        pose=_encode_pose(shape),
        size=_encode_vector(shape.size),
        bottom_scale=shape.bottom,
        top_scale=shape.top,
        color=_encode_color(shape.colour),
    )


def _encode_arrow(shape: ArrowShape) -> fg.ArrowPrimitive:
    head = HEAD_SHARE * shape.length
    return fg.ArrowPrimitive(
        pose=_encode_pose(shape),
        shaft_length=shape.length - head,
        shaft_diameter=shape.thickness,
        head_length=head,
        head_diameter=HEAD * shape.thickness,
        color=_encode_color(shape.colour),
    )


def _encode_line(shape: PolylineShape) -> fg.LinePrimitive:
    kinds = fg.LinePrimitiveLineType
    return fg.LinePrimitive(
        type=kinds.LineList if shape.pairs else kinds.LineStrip,
        pose=_encode_pose(shape),
        thickness=shape.thickness,
        points=[fg.Point3(x=x, y=y, z=z) for x, y, z in shape.points],
        color=_encode_color(shape.colour),
    )


def _encode_label(shape: BillboardText) -> fg.TextPrimitive:
    return fg.TextPrimitive(
        pose=_encode_pose(shape),
        billboard=True,  # always faces the viewer
        font_size=shape.height,
        color=_encode_color(shape.colour),
        text=shape.text,
    )
