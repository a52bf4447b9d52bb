"""Scenes of the bearing studies."""

from dataclasses import dataclass
from typing import Final, final

from lta_flight.flight_spec import FlightSpec, load_spec

DIODES: Final = 'vehicle.sensors.diodes'


@final
@dataclass(frozen=True, slots=True)
class BearingScenario:
    """A named scenario file of the bearing studies."""

    name: str
    scenario: str
    about: str


PLACES: Final[dict[str, BearingScenario]] = {
    'indoor': BearingScenario('indoor', 'lamp_room', 'a room with reflecting surfaces'),
    'outdoor': BearingScenario(
        'outdoor', 'sunny_field', 'a field in full daylight, 80 klx on the ground'
    ),
}


def build_flight_spec(place: BearingScenario, vehicle: str, count: int) -> FlightSpec:
    """Return the spec of a vehicle with an even ring of diodes at a place."""
    return load_spec(vehicle, place.scenario, 'bag', '').with_values({f'{DIODES}.count': count})
