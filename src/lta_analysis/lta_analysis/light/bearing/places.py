"""Where bearings are judged: a scene, and the diodes that are fitted for its light."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, final

from lta_analysis.ingredients import gather, Ingredients

DIODES: Final = 'vehicle.sensors.diodes'


@final
@dataclass(frozen=True, slots=True)
class Place:
    """
    A scene with some of its numbers replaced.

    Parameters
    ----------
    name : str
        What it is called.
    scenario : str
        Its file.
    about : str
        What is special about it.
    changes : mapping
        Values by path, as in a sweep.

    """

    name: str
    scenario: str
    about: str
    changes: Mapping[str, Any] = field(default_factory=dict)


PLACES: Final[dict[str, Place]] = {
    'indoor': Place('indoor', 'lamp_room', 'the shared room, whose surfaces reflect'),
    'outdoor': Place(
        'outdoor',
        'windy_field',
        'a field in daylight of 80 klux, its diodes fitted for it',
        {
            'scenario.ambient.steady': '80000 lx',
            # Full scale at some 110 klux, so that daylight does not saturate.
            f'{DIODES}.feedback': '1.5 kohm',
        },
    ),
}


def made_of(place: Place, vehicle: str, count: int) -> Ingredients:
    """Return vehicle and scene of a place with a number of diodes in an even ring."""
    return gather(vehicle, place.scenario, 'bag', '').with_values(
        {**place.changes, f'{DIODES}.count': count}
    )
