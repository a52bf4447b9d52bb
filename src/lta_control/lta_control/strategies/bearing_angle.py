"""
BAG, bearing angle guidance: the heading is the bearing of the lamp (the paper's first strategy).

With no lamp in sight it stops and turns, so that the light is found from any start.
"""

from typing import final

from lta_control.strategies.protocol import Course, CruiseSettings, Sight


@final
class BearingAngle:
    """Head for the lamp; memory is the last heading asked for."""

    def start(self, heading: float) -> tuple[float, ...]:
        """Return the memory before the first sight: keep the heading."""
        return (heading,)

    def steer(
        self, settings: CruiseSettings, memory: tuple[float, ...], sight: Sight
    ) -> tuple[Course, tuple[float, ...]]:
        """Return the heading of the lamp at cruise speed, or a slow turn on the spot."""
        if sight.bearing is None:
            heading = memory[0] + settings.search_rate * sight.interval
            return Course(heading, 0.0), (heading,)
        heading = sight.heading + sight.bearing
        return Course(heading, settings.speed), (heading,)
