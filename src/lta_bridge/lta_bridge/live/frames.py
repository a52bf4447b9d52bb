"""Where the frames are that messages name: the vehicle in the map, the sensors on the vehicle."""

import math
from typing import final, NamedTuple

from lta_bridge.live.craft import BASE
from lta_bridge.live.room import MAP
from lta_bridge.live.shapes import LEVEL, Three, three, Turn
from lta_model.vehicle import Vehicle

_HALF = math.sqrt(0.5)
DOWN: Turn = (0.0, _HALF, 0.0, _HALF)  # turns x down, as a range finder's must point
BACK: Turn = (0.0, 0.0, 1.0, 0.0)  # turns x backwards


@final
class Frame(NamedTuple):
    """A frame in its parent: where its origin is [m], and how it is turned."""

    parent: str
    name: str
    place: Three
    turn: Turn


def towards(axis: Three) -> Turn:
    """Return the shortest turn of x, where a light sensor must point, to a unit axis."""
    x, y, z = axis
    length = math.sqrt(2.0 + 2.0 * x)
    if length < 1e-6:
        return BACK
    return (0.0, -z / length, y / length, 0.5 * length)


def sensor_frames(vehicle: Vehicle) -> list[Frame]:
    """Return the frames of the sensors, which stand still in the vehicle's."""
    sensors = vehicle.file.sensors
    return [
        Frame(BASE, 'imu_link', three(sensors.imu_position.vector), LEVEL),
        Frame(BASE, 'range_link', three(sensors.range_position.vector), DOWN),
        Frame(BASE, 'panel_link', vehicle.file.panel_place, towards(vehicle.file.panel_normal)),
    ]


def vehicle_frame(place: Three, turn: Turn) -> Frame:
    """Return the vehicle's frame in the map."""
    return Frame(MAP, BASE, place, turn)
