# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draw the room of a scenario in the map frame, and a vehicle in its own."""

import math
from typing import Final

from lta_model import mass_properties
from lta_model.drawing.shapes import (
    BillboardText,
    BoxShape,
    Colour,
    CylinderShape,
    EllipsoidShape,
    move_point,
    NO_SHIFT,
    PolylineShape,
    rotation_between,
    Shape,
    ShapeEntity,
    Three,
    to_triple,
    Z,
)
from lta_model.light.lamp import BeaconLamp
from lta_model.scenario import Scenario
from lta_model.scenario_light import LampScene
from lta_model.vehicle import Vehicle

MAP: Final = 'map'
FLOOR_COLOUR: Final[Colour] = (0.50, 0.52, 0.55, 0.25)
EDGE_COLOUR: Final[Colour] = (0.50, 0.52, 0.55, 1.0)
SOLID: Final[Colour] = (0.50, 0.52, 0.55, 0.10)
LAMP_COLOUR: Final[Colour] = (1.0, 0.85, 0.20, 1.0)
BEAM_COLOUR: Final[Colour] = (1.0, 0.90, 0.40, 0.12)
GOAL_COLOUR: Final[Colour] = (0.20, 0.65, 0.30, 1.0)
WALL_SIZE: Final = 0.01  # m, thickness of a floor or wall
BULB: Final = 0.12  # m across
BEAM_LENGTH: Final = 1.0  # m, length of the drawn light cone; the light reaches farther
GOAL_CORNERS: Final = 48  # of the circle around the goal


def half_power_angle(lamp: BeaconLamp) -> float:
    """Return the angle off the lamp's axis at which it shines half as bright [rad]."""
    # Lambertian emitter: intensity cos(angle) ** order
    return math.acos(0.5 ** (1.0 / lamp.order))


def draw_static_scene(scenario: Scenario) -> list[ShapeEntity]:
    """Return all static shapes of a scenario."""
    lamps = [draw_lamp(name, scene) for name, scene in scenario.lamps.items()]
    return [draw_walls(scenario), *lamps, draw_goals(scenario)]


def draw_walls(scenario: Scenario) -> ShapeEntity:
    """Return the floor and the edges of the room; walls only if they stop a drone."""
    length, width, height = scenario.room.size.vector
    x, y = length / 2, width / 2
    shapes: list[BoxShape | PolylineShape] = [
        BoxShape((0.0, 0.0, -WALL_SIZE / 2), (length, width, WALL_SIZE), FLOOR_COLOUR),
        PolylineShape(tuple(_box_edges(x, y, height)), 0.02, EDGE_COLOUR, pairs=True),
    ]
    if scenario.room.walls == 'solid':
        for side in (-1.0, 1.0):
            shapes.append(BoxShape((side * x, 0.0, height / 2), (WALL_SIZE, width, height), SOLID))
            shapes.append(
                BoxShape((0.0, side * y, height / 2), (length, WALL_SIZE, height), SOLID)
            )
    return ShapeEntity('room', MAP, tuple(shapes))


def _box_edges(x: float, y: float, height: float) -> list[Three]:
    """Return the twelve edges of a box, as pairs of points."""
    ring = [(x, y), (-x, y), (-x, -y), (x, -y)]
    points: list[Three] = []
    for (a, b), (c, d) in zip(ring, [*ring[1:], ring[0]], strict=True):
        points += [(a, b, 0.0), (c, d, 0.0), (a, b, height), (c, d, height)]
        points += [(a, b, 0.0), (a, b, height)]
    return points


def draw_lamp(name: str, scene: LampScene) -> ShapeEntity:
    """Return a lamp, and the cone in which it is at least half as bright as ahead."""
    source = scene.lamp
    place = to_triple(source.position)
    size = math.hypot(*source.axis)
    axis = to_triple(tuple(number / size for number in source.axis))
    edge = half_power_angle(source)
    # The edge of the cone has the length of the beam
    across, ahead = 2.0 * BEAM_LENGTH * math.sin(edge), BEAM_LENGTH * math.cos(edge)
    cone = CylinderShape(
        move_point(place, axis, ahead / 2),
        (across, across, ahead),
        BEAM_COLOUR,
        rotation_between(Z, axis),
        bottom=0.0,  # the tip of the cone is at the lamp
    )
    words = BillboardText(
        move_point(place, Z, 0.3), f'{name}, {scene.frequency.si:g} Hz', 0.15, LAMP_COLOUR
    )
    shapes = EllipsoidShape(place, (BULB, BULB, BULB), LAMP_COLOUR), cone, words
    return ShapeEntity(f'lamp/{name}', MAP, shapes)


def draw_goals(scenario: Scenario) -> ShapeEntity:
    """Return the circles on the floor within which the lamps of the route count as reached."""
    radius = scenario.goal.radius.si
    # One more point, to close the circle
    angles = [2.0 * math.pi * k / GOAL_CORNERS for k in range(GOAL_CORNERS + 1)]
    circles = [
        PolylineShape(
            tuple((x + radius * math.cos(a), y + radius * math.sin(a), 0.0) for a in angles),
            0.02,
            GOAL_COLOUR,
        )
        for x, y in scenario.goal_places
    ]
    return ShapeEntity('goal', MAP, tuple(circles))


BASE: Final = 'base_link'
# Transparent, so that the gondola stays visible
ENVELOPE: Final[Colour] = (0.80, 0.84, 0.90, 0.45)
PART_COLOUR: Final[Colour] = (0.35, 0.40, 0.47, 1.0)
PANEL: Final[Colour] = (0.10, 0.22, 0.50, 1.0)
DISC: Final[Colour] = (0.15, 0.60, 0.75, 0.55)
PANEL_WORD: Final = 'panel'  # part of the name of solar panels
FLAT: Final = 0.1  # thickness of a rotor's disc by its radius
DISC_RADIUS: Final = 0.12  # disc radius by the vehicle's reach: the vehicle file has no rotor size


def vehicle_reach(vehicle: Vehicle) -> float:
    """Return the largest extent of the vehicle from the hull centre [m]."""
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
            EllipsoidShape(NO_SHIFT, to_triple(tuple(2.0 * axis for axis in half)), ENVELOPE)
        )
    boxes = [
        BoxShape(
            to_triple(part.position.vector),
            to_triple(part.size.vector),
            PANEL if PANEL_WORD in name else PART_COLOUR,
        )
        for name, part in vehicle.file.parts.items()
        if part.shape == 'box'
    ]
    radius = DISC_RADIUS * vehicle_reach(vehicle)
    size = (2.0 * radius, 2.0 * radius, FLAT * radius)
    discs = [
        CylinderShape(rotor.place, size, DISC, rotation_between(Z, rotor.axis))
        for rotor in vehicle.rotors
    ]
    shapes += [*boxes, *discs]
    if not boxes:  # without parts, draw a body at the centre of gravity
        centre = to_triple(tuple(float(number) for number in vehicle.cg))
        points = tuple(point for rotor in vehicle.rotors for point in (centre, rotor.place))
        shapes.append(PolylineShape(points, 0.2 * radius, PART_COLOUR, pairs=True))
    return ShapeEntity('vehicle', BASE, tuple(shapes))
