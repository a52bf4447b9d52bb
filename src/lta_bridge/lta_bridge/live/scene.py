"""The scene of a flight: what stands, what moves, and where the frames are."""

import math
from typing import final, NamedTuple

from lta_bridge.live.craft import bearing, body, reach, thrust
from lta_bridge.live.frames import Frame, sensor_frames, vehicle_frame
from lta_bridge.live.room import MAP, standing
from lta_bridge.live.shapes import along, Arrow, Entity, LEVEL, ORIGIN, shifted, Three, Turn, X, Z
from lta_bridge.live.track import Track
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle

RAY = 2.0  # m, of the bearing
CALM = 0.01  # m/s below which no wind is drawn
WIND = (0.45, 0.75, 0.95, 1.0)


class State(NamedTuple):
    """
    What moves in a scene.

    Attributes
    ----------
    place, turn : tuple
        The hull centre in the map [m], and the attitude.
    duties : dict of str to float
        Commanded duty by actuator. [1]
    seen : 3-tuple
        The bearing vector, zero where no lamp is seen. [1, base_link]
    wind : 3-tuple
        Velocity of the air at the hull. [m/s, map]

    """

    place: Three = ORIGIN
    turn: Turn = LEVEL
    duties: dict[str, float] = {}  # noqa: RUF012 - never changed
    seen: Three = ORIGIN
    wind: Three = ORIGIN


@final
class Scene:
    """
    The scene of one vehicle in one scenario.

    Parameters
    ----------
    vehicle : Vehicle
        Gives hull, parts, rotors and sensors.
    scenario : Scenario
        Gives room, lamps and goals.

    """

    def __init__(self, vehicle: Vehicle, scenario: Scenario) -> None:
        self._vehicle = vehicle
        self._above = reach(vehicle) + 0.2
        self._sensors = sensor_frames(vehicle)
        self.track = Track()
        self.standing = [*standing(scenario), body(vehicle)]

    def moving(self, state: State) -> list[Entity]:
        """Return thrust, bearing and wind; the path goes on to where the vehicle is."""
        self.track.add(state.place)
        return [
            thrust(self._vehicle, state.duties),
            bearing(self._vehicle, state.seen, RAY),
            self._wind(state),
        ]

    def path(self) -> Entity:
        """Return the path so far."""
        return self.track.entity(MAP)

    def frames(self, state: State) -> list[Frame]:
        """Return where the vehicle is in the map, and the sensors on it."""
        return [vehicle_frame(state.place, state.turn), *self._sensors]

    def _wind(self, state: State) -> Entity:
        """Return the wind as an arrow above the vehicle, a metre long for each m/s."""
        speed = math.hypot(*state.wind)
        if not speed > CALM:
            return Entity('wind', MAP, ())
        tail = shifted(state.place, Z, self._above)
        return Entity('wind', MAP, (Arrow(tail, speed, 0.05, WIND, along(X, state.wind)),))
