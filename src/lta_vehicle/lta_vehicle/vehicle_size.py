"""What a pilot can weigh and measure of a vehicle, for its first vehicle file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.quantity import describe_misfit, Quantity, SI_UNITS
from pydantic import ValidationError

MOTOR_LAYOUTS: Final = {
    2: 'one on each side pushing forward, none up',
    3: 'one on each side pushing forward, one in the middle pushing up',
    4: 'one on each side pushing forward, and two pushing up',
}
# Quantities that are asked for: unit, limits
LIMITS: Final[Mapping[str, tuple[str, float, float]]] = {
    'length': ('m', 0.1, 50.0),
    'height': ('m', 0.1, 50.0),
    'diameter': ('m', 0.1, 20.0),
    'mass': ('kg', 0.01, 100.0),
    'thrust': ('N', 1e-3, 100.0),
    'arm': ('m', 0.01, 4.9),
    'hang': ('m', 0.01, 4.9),
    'envelope': ('kg', 1e-3, 100.0),
    'heaviness': ('kg', -0.1, 1.0),
    'battery': ('C', 1.0, 1e6),
}


@final
@dataclass(frozen=True, slots=True)
class VehicleSize:
    """What is known of a new vehicle, in SI; None where a value is assumed."""

    # Envelope: a cigar along x has a length, a flattened balloon a height, a sphere neither [m]
    diameter: float
    mass: float  # everything without gas and ballast [kg]
    motors: int  # number of motors
    thrust: float  # of each motor at full duty [N]
    arm: float  # distance of the side motors from the middle [m]
    length: float | None = None  # [m]
    height: float | None = None  # [m]
    hang: float | None = None  # of gondola and motors below the centre of the envelope [m]
    envelope: float | None = None  # mass of the empty envelope [kg]
    heaviness: float | None = None  # weight less lift, with ballast [kg]
    battery: float | None = None  # charge of the battery [C]


def parse_size(name: str, text: str) -> float:
    """Return a quantity such as '1.2m' in SI; raise `BadInput` if it is not one for `name`."""
    unit, low, high = LIMITS[name]
    unit_names = [word for word, (kind, _) in SI_UNITS.items() if kind == unit]
    try:
        # Capacities are written without the space of the unit
        quantity = Quantity.model_validate(text.replace('Ah', 'A h'))
    except ValidationError:
        raise BadInput(
            f"--{name} is '{text}'; write a number and a unit ({', '.join(unit_names)}), such as "
            f"'{0.5 * (low + min(high, 10.0)):.2g} {unit_names[0]}'."
        ) from None
    if complaint := describe_misfit(quantity, unit, low, high):
        raise BadInput(f'--{name} {complaint}.')
    return quantity.si
