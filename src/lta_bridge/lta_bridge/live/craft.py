"""The vehicle as shapes in its own frame: hull, parts, rotors, and the thrust they give."""

from collections.abc import Mapping
from typing import Final

from lta_bridge.live.shapes import (
    along,
    Arrow,
    Box,
    Colour,
    Cylinder,
    Ellipsoid,
    Entity,
    Line,
    ORIGIN,
    Shape,
    shifted,
    three,
    X,
    Z,
)
from lta_model import hull
from lta_model.vehicle import Vehicle

BASE: Final = 'base_link'
ENVELOPE: Final[Colour] = (0.80, 0.84, 0.90, 0.45)  # see-through: what hangs below must show
PART: Final[Colour] = (0.35, 0.40, 0.47, 1.0)
PANEL: Final[Colour] = (0.10, 0.22, 0.50, 1.0)
DISC: Final[Colour] = (0.15, 0.60, 0.75, 0.55)
THRUST: Final[Colour] = (0.90, 0.35, 0.10, 1.0)
PANELS: Final = 'panel'  # in the name of a part that harvests
FLAT: Final = 0.1  # thickness of a rotor's disc by its radius
ROTOR: Final = 0.12  # radius of a disc by the vehicle's reach: no file says how large rotors are


def reach(vehicle: Vehicle) -> float:
    """Return how far the vehicle extends from the hull centre along its longest axis. [m]"""
    ends = list(hull.half_axes(vehicle.file.hull))
    for rotor in vehicle.rotors:
        ends += [abs(number) for number in rotor.place]
    return max(ends)


def body(vehicle: Vehicle) -> Entity:
    """Return what never moves within the vehicle: hull, boxes and discs."""
    shapes: list[Shape] = []
    half = hull.half_axes(vehicle.file.hull)
    if any(half):
        shapes.append(Ellipsoid(ORIGIN, three(tuple(2.0 * axis for axis in half)), ENVELOPE))
    boxes = [
        Box(
            three(part.position.vector),
            three(part.size.vector),
            PANEL if PANELS in name else PART,
        )
        for name, part in vehicle.file.parts.items()
        if part.shape == 'box'
    ]
    radius = ROTOR * reach(vehicle)
    size = (2.0 * radius, 2.0 * radius, FLAT * radius)
    discs = [Cylinder(rotor.place, size, DISC, along(Z, rotor.axis)) for rotor in vehicle.rotors]
    shapes += [*boxes, *discs]
    if not boxes:  # nothing else says what holds the rotors
        centre = three(tuple(float(number) for number in vehicle.cg))
        points = tuple(point for rotor in vehicle.rotors for point in (centre, rotor.place))
        shapes.append(Line(points, 0.2 * radius, PART, pairs=True))
    return Entity('vehicle', BASE, tuple(shapes))


def thrust(vehicle: Vehicle, duties: Mapping[str, float]) -> Entity:
    """
    Return the rotors' forces as arrows, as long as the vehicle reaches at full duty.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    duties : mapping
        Commanded duty by actuator name; a rotor without one gives no arrow. [1]

    """
    longest = reach(vehicle)
    arrows = []
    for rotor in vehicle.rotors:
        duty = duties.get(rotor.name, 0.0)
        share = abs(duty) * (rotor.a * abs(duty) + rotor.b) / rotor.full
        if share > 0.0:
            direction = three(tuple(number if duty > 0.0 else -number for number in rotor.axis))
            arrows.append(
                Arrow(rotor.place, share * longest, 0.04 * longest, THRUST, along(X, direction))
            )
    return Entity('thrust', BASE, tuple(arrows))


def bearing(vehicle: Vehicle, seen: tuple[float, float, float], length: float) -> Entity:
    """
    Return where the light is believed to come from, as a ray from the ring of photodiodes.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    seen : 3-tuple
        The bearing vector, of any length; zero where no lamp is seen. [1, base_link]
    length : float
        Of the ray. [m]

    """
    size = sum(number * number for number in seen) ** 0.5
    if size == 0.0:
        return Entity('bearing', BASE, ())
    ring = (0.0, 0.0, float(vehicle.file.sensors.diodes.height.si))
    end = shifted(ring, three(tuple(number / size for number in seen)), length)
    return Entity('bearing', BASE, (Line((ring, end), 0.02, (0.95, 0.75, 0.10, 1.0)),))
