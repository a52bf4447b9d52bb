"""Frames of the messages: the vehicle in the map, the sensors on the vehicle."""

import math
from typing import final, NamedTuple

from lta_bridge.live.room_shapes import MAP
from lta_bridge.live.shapes import LEVEL, Three, to_triple, Turn
from lta_bridge.live.vehicle_shapes import BASE
from lta_model.vehicle import Vehicle

_HALF = math.sqrt(0.5)
DOWN: Turn = (0.0, _HALF, 0.0, _HALF)  # turns x down, as a range finder's must point
BACK: Turn = (0.0, 0.0, 1.0, 0.0)  # turns x backwards


@final
class SceneFrame(NamedTuple):
    """Position [m] and attitude of a frame in its parent."""

    parent: str
    name: str
    place: Three
    turn: Turn


def rotation_from_x(axis: Three) -> Turn:
    """Return the shortest rotation from x, a light sensor's direction, to a unit vector."""
    x, y, z = axis
    length = math.sqrt(2.0 + 2.0 * x)
    if length < 1e-6:
        return BACK
    return (0.0, -z / length, y / length, 0.5 * length)


def list_sensor_frames(vehicle: Vehicle) -> list[SceneFrame]:
    """Return the frames of the sensors, fixed to the vehicle."""
    sensors = vehicle.file.sensors
    return [
        SceneFrame(BASE, 'imu_link', to_triple(sensors.imu_position.vector), LEVEL),
        SceneFrame(BASE, 'range_link', to_triple(sensors.range_position.vector), DOWN),
        SceneFrame(
            BASE,
            'panel_link',
            vehicle.file.panel_place,
            rotation_from_x(vehicle.file.panel_normal),
        ),
    ]


def build_vehicle_frame(place: Three, turn: Turn) -> SceneFrame:
    """Return the vehicle's frame in the map."""
    return SceneFrame(MAP, BASE, place, turn)
