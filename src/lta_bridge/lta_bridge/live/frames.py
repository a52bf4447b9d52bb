"""Where the frames are that messages name: the vehicle in the map, the sensors on the vehicle."""

import math
from typing import final, NamedTuple

from lta_bridge.live.craft import BASE
from lta_bridge.live.room import MAP
from lta_bridge.live.shapes import LEVEL, Three, three, Turn
from lta_sim.vehicle import Vehicle

_HALF = math.sqrt(0.5)
DOWN: Turn = (0.0, _HALF, 0.0, _HALF)  # turns x down, as a range finder's must point
UP: Turn = (0.0, -_HALF, 0.0, _HALF)  # turns x up, as a light sensor's must point


@final
class Frame(NamedTuple):
    """A frame in its parent: where its origin is [m], and how it is turned."""

    parent: str
    name: str
    place: Three
    turn: Turn


def sensor_frames(vehicle: Vehicle) -> list[Frame]:
    """Return the frames of the sensors, which stand still in the vehicle's."""
    sensors = vehicle.file.sensors
    return [
        Frame(BASE, 'imu_link', three(sensors.imu_position.vector), LEVEL),
        Frame(BASE, 'range_link', three(sensors.range_position.vector), DOWN),
        Frame(BASE, 'panel_link', vehicle.file.panel_place, UP),
    ]


def vehicle_frame(place: Three, turn: Turn) -> Frame:
    """Return the vehicle's frame in the map."""
    return Frame(MAP, BASE, place, turn)
