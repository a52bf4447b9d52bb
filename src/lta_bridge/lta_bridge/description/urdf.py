# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Convert a vehicle file to URDF, for RViz, Foxglove, robot_state_publisher and other tools.

Links are the frames of the messages (docs/topics.md): `base_link` at the hull centre, FLU, with
all visuals; the sensors' frames fixed to it; `rotor_NAME` for each rotor, z along its thrust; and
`cg_link` at the centre of gravity, with the mass and inertia of the whole vehicle: KDL, and with
it robot_state_publisher, wants a root without inertia. URDF has no ellipsoid, and a mesh file
would have to be on the viewer's machine, so the hull is a stack of discs.
"""

from collections.abc import Iterator, Sequence
import math
from typing import Final, final, NamedTuple
from xml.etree import ElementTree

from lta_model.drawing.scene import BASE, draw_body
from lta_model.drawing.shapes import (
    BoxShape,
    Colour,
    CylinderShape,
    EllipsoidShape,
    NO_TURN,
    PolylineShape,
    rotation_between,
    Three,
    to_triple,
    Turn,
    X,
    Z,
)
from lta_model.vehicle import Vehicle

Element = ElementTree.Element
CG: Final = 'cg_link'
DISCS: Final = 15  # per hull: the largest step at its side is 2 % of its radius
CHIP: Final[Three] = (0.02, 0.02, 0.01)  # m, box drawn for a sensor
CHIP_COLOUR: Final[Colour] = (0.85, 0.55, 0.10, 1.0)
LOCK: Final = 1e-7  # rad from a pitch of +-90 deg, where only yaw - roll or yaw + roll is defined
DIODE: Final[Three] = (0.005, 0.01, 0.01)  # m; an OPT101 in its DIP package, looking along x
# Turns x down, as a range finder's must point
TURN_DOWN: Turn = (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5))


@final
class SceneFrame(NamedTuple):
    """Position [m] and attitude of a frame in its parent."""

    parent: str
    name: str
    place: Three
    turn: Turn


def list_sensor_frames(vehicle: Vehicle) -> list[SceneFrame]:
    """Return the frames of the sensors, fixed to the vehicle."""
    sensors = vehicle.file.sensors
    return [
        SceneFrame(BASE, 'imu_link', to_triple(sensors.imu_position.vector), NO_TURN),
        SceneFrame(BASE, 'range_link', to_triple(sensors.range_position.vector), TURN_DOWN),
        SceneFrame(
            BASE,
            'panel_link',
            vehicle.file.panel_place,
            rotation_between(X, vehicle.file.panel_normal),
        ),
    ]


def build_urdf(vehicle: Vehicle) -> str:
    """Return the URDF of a vehicle as XML text, in metres and kilograms."""
    robot = Element('robot', name=vehicle.file.name)
    base = ElementTree.SubElement(robot, 'link', name=BASE)
    for shape in draw_body(vehicle).shapes:
        match shape:
            case EllipsoidShape():
                for disc in slice_into_discs(shape):
                    _add_visual(base, disc)
            case PolylineShape():
                for rod in convert_to_rods(shape):
                    _add_visual(base, rod)
            case BoxShape() | CylinderShape():
                _add_visual(base, shape)
    for diode in build_diode_boxes(vehicle):
        _add_visual(base, diode)
    sensors = {frame.name for frame in list_sensor_frames(vehicle)}
    for frame in list_fixed_frames(vehicle):
        link = _add_link(robot, frame)
        if frame.name == CG:
            _add_inertial(link, vehicle)
        if frame.name in sensors:
            _add_visual(link, BoxShape((0.0, 0.0, 0.0), CHIP, CHIP_COLOUR))
    ElementTree.indent(robot)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(robot, encoding='unicode') + '\n'


def list_fixed_frames(vehicle: Vehicle) -> list[SceneFrame]:
    """Return the frames fixed to the vehicle: centre of gravity, sensors and rotors."""
    rotors = [
        SceneFrame(BASE, f'rotor_{rotor.name}', rotor.place, rotation_between(Z, rotor.axis))
        for rotor in vehicle.rotors
    ]
    gravity = SceneFrame(BASE, CG, to_triple(vehicle.cg.tolist()), NO_TURN)
    return [gravity, *list_sensor_frames(vehicle), *rotors]


def slice_into_discs(hull: EllipsoidShape) -> Iterator[CylinderShape]:
    """
    Yield equally thick discs along the axis of revolution, with the hull's volume.

    The mean of 1 - s^2 over a disc from s to s' is 1 - (s^2 + s s' + s'^2) / 3.
    """
    half = [0.5 * size for size in hull.size]
    # The axis of revolution is the one whose two other half-axes differ least.
    axis = min(range(3), key=lambda k: abs(half[k - 1] - half[k - 2]))
    across = 0.5 * (half[axis - 1] + half[axis - 2])
    direction: Three = (float(axis == 0), float(axis == 1), float(axis == 2))
    # URDF cylinders lie along z
    turn = rotation_between(Z, direction)
    for k in range(DISCS):
        low, high = (2.0 * edge / DISCS - 1.0 for edge in (k, k + 1))
        # Mean of the squared radius over the slice, so that each disc has the slice's volume
        radius = across * math.sqrt(1.0 - (low * low + low * high + high * high) / 3.0)
        middle = half[axis] * 0.5 * (low + high)
        place: Three = (
            hull.place[0] + middle * direction[0],
            hull.place[1] + middle * direction[1],
            hull.place[2] + middle * direction[2],
        )
        size: Three = (2.0 * radius, 2.0 * radius, 2.0 * half[axis] / DISCS)
        yield CylinderShape(place, size, hull.colour, turn)


def convert_to_rods(line: PolylineShape) -> Iterator[CylinderShape]:
    """Yield the strokes of a line as round rods, because URDF has no lines."""
    # Points are pairs: start and end of each stroke
    for start, end in zip(line.points[::2], line.points[1::2], strict=True):
        length = math.dist(start, end)
        middle = to_triple([0.5 * (p + q) for p, q in zip(start, end, strict=True)])
        turn = rotation_between(Z, to_triple([q - p for p, q in zip(start, end, strict=True)]))
        yield CylinderShape(middle, (line.thickness, line.thickness, length), line.colour, turn)


def build_diode_boxes(vehicle: Vehicle) -> Iterator[BoxShape]:
    """Yield the photodiodes where they sit, looking along their axes."""
    for row in vehicle.diodes.planes.tolist():
        yield BoxShape(
            to_triple(row[:3]), DIODE, CHIP_COLOUR, rotation_between(X, to_triple(row[3:]))
        )


def _add_link(robot: Element, frame: SceneFrame) -> Element:
    """Add a link that is fixed to another, and return it."""
    link = ElementTree.SubElement(robot, 'link', name=frame.name)
    joint = ElementTree.SubElement(robot, 'joint', name=f'{frame.name}_joint', type='fixed')
    ElementTree.SubElement(joint, 'parent', link=frame.parent)
    ElementTree.SubElement(joint, 'child', link=frame.name)
    joint.append(_build_origin(frame.place, frame.turn))
    return link


def _add_inertial(link: Element, vehicle: Vehicle) -> None:
    """Add the mass, and the inertia about the link; with the gas, without added mass."""
    inertial = ElementTree.SubElement(link, 'inertial')
    ElementTree.SubElement(inertial, 'mass', value=f'{vehicle.mass:.9g}')
    tensor = vehicle.inertia
    names = {'ixx': (0, 0), 'ixy': (0, 1), 'ixz': (0, 2), 'iyy': (1, 1), 'iyz': (1, 2),
             'izz': (2, 2)}  # fmt: skip
    values = {name: f'{float(tensor[where]):.9g}' for name, where in names.items()}
    ElementTree.SubElement(inertial, 'inertia', values)


def _add_visual(link: Element, shape: BoxShape | CylinderShape) -> None:
    """Add a shape to a link's visuals."""
    visual = ElementTree.SubElement(link, 'visual')
    visual.append(_build_origin(shape.place, shape.turn))
    geometry = ElementTree.SubElement(visual, 'geometry')
    if isinstance(shape, BoxShape):
        ElementTree.SubElement(geometry, 'box', size=_format_numbers(shape.size))
    else:
        size = {'radius': f'{0.5 * shape.size[0]:.6g}', 'length': f'{shape.size[2]:.6g}'}
        ElementTree.SubElement(geometry, 'cylinder', size)
    material = ElementTree.SubElement(visual, 'material', name=_format_color_name(shape.colour))
    ElementTree.SubElement(material, 'color', rgba=_format_numbers(shape.colour))


def _build_origin(place: Three, turn: Turn) -> Element:
    """Return the origin of a pose; URDF's rpy is about fixed axes, x first."""
    return Element('origin', xyz=_format_numbers(place), rpy=_format_numbers(to_rpy(turn)))


def to_rpy(turn: Turn) -> Three:
    """
    Return roll, pitch and yaw of a quaternion x y z w [rad].

    Plain numbers, because scipy takes a third of a second to import.
    """
    x, y, z, w = turn
    # Half the sum and half the difference of roll and yaw stay exact where pitch is +-90 deg
    pitch = 2.0 * math.atan2(math.hypot(y + w, z - x), math.hypot(w - y, x + z)) - 0.5 * math.pi
    plus, minus = math.atan2(x + z, w - y), math.atan2(x - z, w + y)
    if min(abs(pitch - 0.5 * math.pi), abs(pitch + 0.5 * math.pi)) < LOCK:
        # Gimbal lock: any split of yaw and roll is valid
        roll, yaw = 2.0 * (plus if pitch < 0.0 else minus), 0.0
    else:
        roll, yaw = plus + minus, plus - minus
    return math.remainder(roll, 2.0 * math.pi), pitch, math.remainder(yaw, 2.0 * math.pi)


def _format_numbers(values: Sequence[float]) -> str:
    # Adding 0.0 turns -0.0 into 0
    return ' '.join(f'{value + 0.0:.6g}' for value in values)


def _format_color_name(colour: Colour) -> str:
    return 'colour_' + '_'.join(f'{round(255 * part):02x}' for part in colour)
