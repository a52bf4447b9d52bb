"""Draw the vehicle in its own frame: hull, parts, rotors and thrust."""

from collections.abc import Mapping
from typing import Final

from lta_bridge.live.shapes import (
    ArrowShape,
    BoxShape,
    Colour,
    CylinderShape,
    EllipsoidShape,
    move_point,
    ORIGIN,
    PolylineShape,
    rotation_between,
    Shape,
    ShapeEntity,
    to_triple,
    X,
    Z,
)
from lta_model import mass_properties
from lta_model.vehicle import Vehicle

BASE: Final = 'base_link'
# Transparent, so that the gondola stays visible
ENVELOPE: Final[Colour] = (0.80, 0.84, 0.90, 0.45)
PART: Final[Colour] = (0.35, 0.40, 0.47, 1.0)
PANEL: Final[Colour] = (0.10, 0.22, 0.50, 1.0)
DISC: Final[Colour] = (0.15, 0.60, 0.75, 0.55)
THRUST: Final[Colour] = (0.90, 0.35, 0.10, 1.0)
PANELS: Final = 'panel'  # part of the name of solar panels
FLAT: Final = 0.1  # thickness of a rotor's disc by its radius
ROTOR: Final = 0.12  # disc radius by the vehicle's reach: the vehicle file has no rotor size


def vehicle_reach(vehicle: Vehicle) -> float:
    """Return the largest extent of the vehicle from the hull centre. [m]"""
    ends = list(mass_properties.half_axes(vehicle.file.hull))
    for rotor in vehicle.rotors:
        ends += [abs(number) for number in rotor.place]
    return max(ends)


def draw_body(vehicle: Vehicle) -> ShapeEntity:
    """Return the static shapes of the vehicle: hull, boxes and discs."""
    shapes: list[Shape] = []
    half = mass_properties.half_axes(vehicle.file.hull)
    if any(half):
        shapes.append(
            EllipsoidShape(ORIGIN, to_triple(tuple(2.0 * axis for axis in half)), ENVELOPE)
        )
    boxes = [
        BoxShape(
            to_triple(part.position.vector),
            to_triple(part.size.vector),
            PANEL if PANELS in name else PART,
        )
        for name, part in vehicle.file.parts.items()
        if part.shape == 'box'
    ]
    radius = ROTOR * vehicle_reach(vehicle)
    size = (2.0 * radius, 2.0 * radius, FLAT * radius)
    discs = [
        CylinderShape(rotor.place, size, DISC, rotation_between(Z, rotor.axis))
        for rotor in vehicle.rotors
    ]
    shapes += [*boxes, *discs]
    if not boxes:  # without parts, draw a body at the centre of gravity
        centre = to_triple(tuple(float(number) for number in vehicle.cg))
        points = tuple(point for rotor in vehicle.rotors for point in (centre, rotor.place))
        shapes.append(PolylineShape(points, 0.2 * radius, PART, pairs=True))
    return ShapeEntity('vehicle', BASE, tuple(shapes))


def draw_thrust(vehicle: Vehicle, duties: Mapping[str, float]) -> ShapeEntity:
    """
    Return the rotors' forces as arrows, as long as the vehicle's reach at full duty.

    `duties` holds the duty by actuator name; a rotor without one gets no arrow. [1]
    """
    longest = vehicle_reach(vehicle)
    arrows = []
    for rotor in vehicle.rotors:
        duty = duties.get(rotor.name, 0.0)
        # Thrust is quadratic in the duty; 1 is full thrust
        share = abs(duty) * (rotor.a * abs(duty) + rotor.b) / rotor.full_thrust
        if share > 0.0:
            direction = to_triple(
                tuple(number if duty > 0.0 else -number for number in rotor.axis)
            )
            arrows.append(
                ArrowShape(
                    rotor.place,
                    share * longest,
                    0.04 * longest,
                    THRUST,
                    rotation_between(X, direction),  # arrows point along their own x
                )
            )
    return ShapeEntity('thrust', BASE, tuple(arrows))


def draw_bearing(
    vehicle: Vehicle, direction: tuple[float, float, float], length: float
) -> ShapeEntity:
    """
    Return the estimated bearing of the lamp as a ray from the ring of photodiodes.

    Parameters
    ----------
    seen : 3-tuple
        The bearing vector, of any length; zero without a detected lamp. [1, base_link]
    length : float
        Length of the ray. [m]

    """
    size = sum(number * number for number in direction) ** 0.5
    if size == 0.0:
        return ShapeEntity('bearing', BASE, ())
    # Centre of the ring of photodiodes
    ring = (0.0, 0.0, float(vehicle.file.sensors.diodes.height.si))
    end = move_point(ring, to_triple(tuple(number / size for number in direction)), length)
    return ShapeEntity(
        'bearing', BASE, (PolylineShape((ring, end), 0.02, (0.95, 0.75, 0.10, 1.0)),)
    )
