"""Draw the scene of a flight: static shapes, moving shapes and frames."""

import math
from typing import final, NamedTuple

from lta_bridge.live.frames import build_vehicle_frame, list_sensor_frames, SceneFrame
from lta_bridge.live.path_trace import PathTrace
from lta_bridge.live.room_shapes import draw_static_scene, MAP
from lta_bridge.live.shapes import (
    ArrowShape,
    LEVEL,
    move_point,
    ORIGIN,
    rotation_between,
    ShapeEntity,
    Three,
    Turn,
    X,
    Z,
)
from lta_bridge.live.vehicle_shapes import draw_bearing, draw_body, draw_thrust, vehicle_reach
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle

RAY = 2.0  # m, length of the bearing ray
CALM = 0.01  # m/s below which no wind is drawn
WIND = (0.45, 0.75, 0.95, 1.0)


class SceneState(NamedTuple):
    """The moving parts of a scene."""

    # The hull centre in the map [m], and the attitude
    place: Three = ORIGIN
    turn: Turn = LEVEL
    # Commanded duty by actuator [1]
    duties: dict[str, float] = {}  # noqa: RUF012 - never changed
    seen: Three = ORIGIN  # the bearing vector; zero without a detected lamp [1, base_link]
    wind: Three = ORIGIN  # velocity of the air at the hull [m/s, map]


@final
class LiveScene:
    """The scene of one vehicle in one scenario."""

    def __init__(self, vehicle: Vehicle, scenario: Scenario) -> None:
        self._vehicle = vehicle
        self._above = vehicle_reach(vehicle) + 0.2
        self._sensors = list_sensor_frames(vehicle)
        self.track = PathTrace()
        self.standing = [*draw_static_scene(scenario), draw_body(vehicle)]

    def draw_moving(self, state: SceneState) -> list[ShapeEntity]:
        """Return thrust, bearing and wind; add the position to the path."""
        self.track.add_position(state.place)
        return [
            draw_thrust(self._vehicle, state.duties),
            draw_bearing(self._vehicle, state.seen, RAY),
            self._draw_wind(state),
        ]

    def draw_path(self) -> ShapeEntity:
        """Return the path so far."""
        return self.track.to_entity(MAP)

    def list_frames(self, state: SceneState) -> list[SceneFrame]:
        """Return the frames of the vehicle and its sensors."""
        return [build_vehicle_frame(state.place, state.turn), *self._sensors]

    def _draw_wind(self, state: SceneState) -> ShapeEntity:
        """Return the wind as an arrow above the vehicle, a metre long for each m/s."""
        speed = math.hypot(*state.wind)
        if not speed > CALM:
            return ShapeEntity('wind', MAP, ())
        tail = move_point(state.place, Z, self._above)
        return ShapeEntity(
            'wind', MAP, (ArrowShape(tail, speed, 0.05, WIND, rotation_between(X, state.wind)),)
        )
