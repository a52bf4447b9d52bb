"""Which flights teach, which confirm and which are held out, where that is not given."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.flights.measured_flight import MeasuredFlight
import numpy as np

Role = tuple[str, str, MeasuredFlight]

ROLES: Final = ('train', 'confirm', 'holdout')
ONE: Final = (0.4, 0.7)  # of the usable time: where what teaches ends, and what confirms
TWO: Final = 0.6  # the same, where only what confirms is missing


def select_part(flight: MeasuredFlight, begin: float, end: float) -> MeasuredFlight:
    """
    Return a flight of which only a part is usable.

    Parameters
    ----------
    flight : Measured
        The whole, which goes on being replayed: lag, gas and battery remember.
    begin, end : float
        Of the usable points, 0 to 1.

    """
    count = np.cumsum(flight.usable) / max(1, int(flight.usable.sum()))
    return replace(flight, usable=flight.usable & (count > begin) & (count <= end))


def assign_roles(flights: Sequence[Role]) -> tuple[list[Role], list[str]]:
    """
    Return flights such that some teach and some confirm, and what that makes weaker.

    Parameters
    ----------
    flights : sequence of (name, role, Measured)
        Roles as in ROLES.

    Returns
    -------
    list of (name, role, Measured), list of str
        The same where nothing is missing; one flight alone in three parts; training flights in
        two, by flights or, if there is one, in time.

    Raises
    ------
    BadInput
        If no flight teaches.

    """
    train = [flight for flight in flights if flight[1] == 'train']
    rest = [flight for flight in flights if flight[1] != 'train']
    if not train:
        raise BadInput('No flight is there to learn from; name at least one bag to train on.')
    if any(role == 'confirm' for _, role, _ in rest):
        return list(flights), []
    if len(train) > 1:
        half = (len(train) + 1) // 2
        moved = [(name, 'confirm', flight) for name, _, flight in train[half:]]
        said = 'No flight was given to confirm by: half of the training flights are held against'
        return [*train[:half], *moved, *rest], [f'{said} the other half.']
    name, _, flight = train[0]
    if rest:
        parts = [
            (name, 'train', select_part(flight, 0.0, TWO)),
            (name, 'confirm', select_part(flight, TWO, 1)),
        ]
        said = 'What was found is confirmed by the later part of the flight that taught it, which'
        return [*parts, *rest], [f'{said} is weaker than another flight.']
    first, second = ONE
    edges = zip(ROLES, (0.0, first, second), (first, second, 1.0), strict=True)
    said = 'One flight teaches, confirms and is held out, part after part, which is weaker than'
    return [(name, role, select_part(flight, a, b)) for role, a, b in edges], [
        f'{said} three flights.'
    ]
