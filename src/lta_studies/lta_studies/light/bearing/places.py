"""Where bearings are judged."""

from dataclasses import dataclass
from typing import Final, final

from lta_flight.ingredients import gather, Ingredients

DIODES: Final = 'vehicle.sensors.diodes'


@final
@dataclass(frozen=True, slots=True)
class Place:
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


PLACES: Final[dict[str, Place]] = {
    'indoor': Place('indoor', 'lamp_room', 'the shared room, whose surfaces reflect'),
    'outdoor': Place('outdoor', 'sunny_field', 'a field in full daylight, 80 klux on the ground'),
}


def made_of(place: Place, vehicle: str, count: int) -> Ingredients:
    """Return vehicle and scene of a place with a number of diodes in an even ring."""
    return gather(vehicle, place.scenario, 'bag', '').with_values({f'{DIODES}.count': count})
