"""Where bearings are judged."""

from dataclasses import dataclass
from typing import Final, final

from lta_flight.flight_spec import FlightSpec, load_spec

DIODES: Final = 'vehicle.sensors.diodes'


@final
@dataclass(frozen=True, slots=True)
class BearingPlace:
    """
    A scene by the name of what it stands for.

    Parameters
    ----------
    name : str
        What it is called.
    scenario : str
        Its file.
    about : str
        What is special about it.

    """

    name: str
    scenario: str
    about: str


PLACES: Final[dict[str, BearingPlace]] = {
    'indoor': BearingPlace('indoor', 'lamp_room', 'the shared room, whose surfaces reflect'),
    'outdoor': BearingPlace(
        'outdoor', 'sunny_field', 'a field in full daylight, 80 klux on the ground'
    ),
}


def build_flight_spec(place: BearingPlace, vehicle: str, count: int) -> FlightSpec:
    """Return vehicle and scene of a place with a number of diodes in an even ring."""
    return load_spec(vehicle, place.scenario, 'bag', '').with_values({f'{DIODES}.count': count})
