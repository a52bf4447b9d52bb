"""Store a flight path with a limited number of points."""

import math
from typing import final

from lta_bridge.live.shapes import PolylineShape, ShapeEntity, Three

TRACE_POINTS = 800  # points
COLOUR = (0.10, 0.45, 0.85, 1.0)


@final
class PathTrace:
    """
    Positions of a vehicle, at least a step [m] apart.

    When there are too many, every second one is dropped and the step is doubled, so that old and
    new parts have the same resolution.
    """

    def __init__(self, step: float = 0.02) -> None:
        self.step = step
        self.points: list[Three] = []

    def add_position(self, place: Three) -> None:
        """Add a position. [m]"""
        if self.points and math.dist(self.points[-1], place) < self.step:
            return
        self.points.append(place)
        if len(self.points) > TRACE_POINTS:
            del self.points[1::2]
            self.step *= 2.0

    def to_entity(self, frame: str) -> ShapeEntity:
        """Return the path as a line."""
        if len(self.points) < 2:
            return ShapeEntity('path', frame, ())
        return ShapeEntity('path', frame, (PolylineShape(tuple(self.points), 0.015, COLOUR),))
