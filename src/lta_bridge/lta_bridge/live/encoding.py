"""Shapes and frames as Foxglove's own messages."""

from collections.abc import Iterable

import foxglove.messages as fg
from lta_bridge.live.frames import Frame
from lta_bridge.live.shapes import (
    Arrow,
    Box,
    Colour,
    Cylinder,
    Ellipsoid,
    Entity,
    Label,
    LEVEL,
    Line,
    ORIGIN,
    Shape,
    Three,
    Turn,
)

HEAD = 2.0  # width of an arrow's head by its shaft's
HEAD_SHARE = 0.25  # of an arrow's length


def scene_update(entities: Iterable[Entity], stamp_ns: int) -> bytes:
    """
    Return entities as a serialised foxglove.SceneUpdate; each replaces the one of its name.

    Parameters
    ----------
    entities : iterable of Entity
        What to draw.
    stamp_ns : int
        Graph time. [ns]

    """
    return fg.SceneUpdate(entities=[_entity(item, stamp_ns) for item in entities]).encode()


def frame_transforms(frames: Iterable[Frame], stamp_ns: int) -> bytes:
    """Return frames as serialised foxglove.FrameTransforms of a graph time. [ns]"""
    stamp = _stamp(stamp_ns)
    return fg.FrameTransforms(
        transforms=[
            fg.FrameTransform(
                timestamp=stamp,
                parent_frame_id=frame.parent,
                child_frame_id=frame.name,
                translation=_vector(frame.place),
                rotation=_quaternion(frame.turn),
            )
            for frame in frames
        ]
    ).encode()


def _entity(item: Entity, stamp_ns: int) -> fg.SceneEntity:
    shapes = item.shapes
    return fg.SceneEntity(
        timestamp=_stamp(stamp_ns),
        frame_id=item.frame,
        id=item.name,
        frame_locked=True,
        arrows=[_arrow(s) for s in shapes if isinstance(s, Arrow)],
        cubes=[
            fg.CubePrimitive(pose=_pose(s), size=_vector(s.size), color=_colour(s.colour))
            for s in shapes
            if isinstance(s, Box)
        ],
        spheres=[
            fg.SpherePrimitive(pose=_pose(s), size=_vector(s.size), color=_colour(s.colour))
            for s in shapes
            if isinstance(s, Ellipsoid)
        ],
        cylinders=[_cylinder(s) for s in shapes if isinstance(s, Cylinder)],
        lines=[_line(s) for s in shapes if isinstance(s, Line)],
        texts=[_label(s) for s in shapes if isinstance(s, Label)],
    )


def _stamp(stamp_ns: int) -> fg.Timestamp:
    return fg.Timestamp(sec=stamp_ns // 1_000_000_000, nsec=stamp_ns % 1_000_000_000)


def _vector(numbers: Three) -> fg.Vector3:
    x, y, z = numbers
    return fg.Vector3(x=x, y=y, z=z)


def _quaternion(turn: Turn) -> fg.Quaternion:
    x, y, z, w = turn
    return fg.Quaternion(x=x, y=y, z=z, w=w)


def _colour(colour: Colour) -> fg.Color:
    r, g, b, a = colour
    return fg.Color(r=r, g=g, b=b, a=a)


def _pose(shape: Shape) -> fg.Pose:
    place = ORIGIN if isinstance(shape, Line) else shape.place
    turn = LEVEL if isinstance(shape, Line | Label) else shape.turn
    return fg.Pose(position=_vector(place), orientation=_quaternion(turn))


def _cylinder(shape: Cylinder) -> fg.CylinderPrimitive:
    return fg.CylinderPrimitive(
        pose=_pose(shape),
        size=_vector(shape.size),
        bottom_scale=shape.bottom,
        top_scale=shape.top,
        color=_colour(shape.colour),
    )


def _arrow(shape: Arrow) -> fg.ArrowPrimitive:
    head = HEAD_SHARE * shape.length
    return fg.ArrowPrimitive(
        pose=_pose(shape),
        shaft_length=shape.length - head,
        shaft_diameter=shape.thickness,
        head_length=head,
        head_diameter=HEAD * shape.thickness,
        color=_colour(shape.colour),
    )


def _line(shape: Line) -> fg.LinePrimitive:
    kinds = fg.LinePrimitiveLineType
    return fg.LinePrimitive(
        type=kinds.LineList if shape.pairs else kinds.LineStrip,
        pose=_pose(shape),
        thickness=shape.thickness,
        points=[fg.Point3(x=x, y=y, z=z) for x, y, z in shape.points],
        color=_colour(shape.colour),
    )


def _label(shape: Label) -> fg.TextPrimitive:
    return fg.TextPrimitive(
        pose=_pose(shape),
        billboard=True,
        font_size=shape.height,
        color=_colour(shape.colour),
        text=shape.text,
    )
