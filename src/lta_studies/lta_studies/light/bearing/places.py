"""Scenes of the bearing studies."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, final, NamedTuple

from lta_flight.flight_spec import FlightSpec, load_spec

DIODES: Final = 'vehicle.sensors.diodes'
# In full daylight people mount a smaller resistor; GT-MAB's own saturates at 2 klx
FOR_SUN: Final = {
    f'{DIODES}.feedback': {
        'value': 10, 'unit': 'kohm', 'source': 'assumed: full scale near 20 klx, for daylight'
    }
}  # fmt: skip


class TrueDiodes(NamedTuple):
    """The simulated diodes where they differ from the vehicle file, which the drone assumes."""

    response: float | None = None  # exponent of the cosine
    gain_spread: float | None = None  # relative standard deviation of the gains


@final
@dataclass(frozen=True, slots=True)
class BearingScenario:
    """A named scenario file of the bearing studies, and what is mounted for it."""

    name: str
    scenario: str
    about: str
    mounted: Mapping[str, object] = field(default_factory=dict)


PLACES: Final[dict[str, BearingScenario]] = {
    'indoor': BearingScenario('indoor', 'lamp_room', 'a room with reflecting surfaces'),
    'outdoor': BearingScenario(
        'outdoor', 'sunny_field', 'a field in full daylight, 80 klx on the ground', FOR_SUN
    ),
}


def build_flight_spec(
    place: BearingScenario, vehicle: str, count: int, diodes: TrueDiodes | None = None
) -> FlightSpec:
    """Return the spec of a vehicle with an even ring at a place; the file's diodes by default."""
    values: dict[str, object] = {f'{DIODES}.count': count, **place.mounted}
    changes = {} if diodes is None else diodes._asdict()
    for name, value in changes.items():
        if value is not None:
            values[f'{DIODES}.{name}'] = {'value': value, 'unit': '1', 'source': 'option'}
    return load_spec(vehicle, place.scenario, 'bag', '').with_values(values)
