"""Flight bounds: the room, and beyond its door as far as the scene reaches."""

from typing import final

from lta_model.scenario import Scenario


@final
class FlightBounds:
    """The bounds of a scene, for one flight from its start."""

    def __init__(self, scenario: Scenario) -> None:
        # The map's origin is on the floor in the middle of the room
        length, width, self._height = scenario.room.size.vector
        self._x, self._y = length / 2, width / 2
        self._outside = scenario.outside
        self._indoors = True  # every flight starts indoors

    def is_inside(self, x: float, y: float, z: float) -> bool:
        """Return whether a hull centre is in bounds; must be called at every step. [m, map]"""
        indoors = abs(x) <= self._x and abs(y) <= self._y and z <= self._height
        outside, crossed = self._outside, indoors != self._indoors
        self._indoors = indoors
        if outside is None:
            return indoors
        door, reach = outside.door, outside.reach.si
        # A change between indoors and outdoors is allowed only through the door.
        if crossed:
            aside = abs(y - door.middle.si)
            return aside <= door.width.si / 2 and z <= door.height.si and x > 0.0
        # The door is in the wall at +x; `reach` limits the outdoor flight ahead, aside and upward
        return indoors or (x <= self._x + reach and abs(y) <= reach and z <= reach)
