"""
Names that no data of a kind can tell apart: frozen before anything is scored by them.

`load_class_map.yaml` beside this file is derived by `make classes` from rich flights of each kind
(see
`lta_discovery.planning.class_derivation`): two names are one where what is left of their columns,
all else marginalised, has a cosine of .98 or more. An effect of z deviations is then told from the
other by z^2 (1 - .98^2) / 2 nats, which is less than the 3 nats that a name needs over the next
one until z is 12: more than most effects can reach, given the tolerances of a vehicle.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Final, Literal

from lta_config.errors import unknown_name
from lta_config.files import load_file, StrictModel
from lta_discovery.flights.measured_flight import MeasuredFlight
import numpy as np
from pydantic import Field

Kind = Literal['all', 'imu', 'pose', 'wrench', 'hover']

FILE: Final = Path(__file__).with_name('classes.yaml')
STILL: Final = 0.15  # m/s; of a flight that only hovers, 9 of 10 points are slower
LEVEL: Final = 0.3  # m; and 8 of 10 within so much height


class DataKindClasses(StrictModel):
    """
    What one kind of data can tell.

    Attributes
    ----------
    classes : list of list of str
        Names that are one; those that are one by themselves are left out.
    unseen : list of str
        Names of which such data say nothing.
    near : mapping of str to float
        Cosine of pairs below the threshold that are hard to tell apart: 'one, other'.
    reach : mapping of str to two numbers
        Deviations that a typical size of each name comes to, its tolerances among them: in the
        flights it was derived from, and however long they are.

    """

    classes: list[list[str]]
    unseen: list[str]
    near: dict[str, float]
    reach: dict[str, Annotated[list[float], Field(min_length=2, max_length=2)]]


class FrozenClasses(StrictModel):
    """The whole file."""

    digest: Annotated[str, Field(pattern='^[0-9a-f]{12}$')]
    vehicle: str
    threshold: float
    flights: int
    length_s: float
    kinds: dict[str, DataKindClasses]


@cache
def load_frozen_classes() -> FrozenClasses:
    """Return what was derived."""
    return load_file(FrozenClasses, FILE)


def find_kind_classes(kind: Kind) -> DataKindClasses:
    """Return what a kind of data can tell; `BadInput` for a kind that is not known."""
    known = load_frozen_classes().kinds
    if kind not in known:
        raise unknown_name('kind of data', kind, list(known))
    return known[kind]


@cache
def load_class_map(kind: Kind) -> Mapping[str, str]:
    """
    Return the class of each name in a kind of data: the first name of those that are one.

    Parameters
    ----------
    kind : str
        'all' sensors, 'imu', 'pose' alone, commands as a 'wrench' with pose alone, or 'hover'.

    """
    found = find_kind_classes(kind)
    out = {name: name for name in found.reach}
    return out | {name: group[0] for group in found.classes for name in group}


def is_same_class(a: str, b: str, kind: Kind) -> bool:
    """Tell whether two names are one to a kind of data; a name that is not known is alone."""
    known = load_class_map(kind)
    return known.get(a, a) == known.get(b, b)


def list_equivalents(name: str, kind: Kind) -> tuple[str, ...]:
    """Return the names that a kind of data takes for this one."""
    known = load_class_map(kind)
    own = known.get(name, name)
    return tuple(one for one, group in known.items() if group == own and one != name)


def classify_data_kind(flights: Sequence[MeasuredFlight]) -> Kind:
    """
    Return the kind of some flights: by what the best of them has.

    Parameters
    ----------
    flights : sequence of Measured
        Of one study.

    """
    if any(flight.wrench is not None for flight in flights):
        return 'wrench'
    if all(_is_hover(flight) for flight in flights):
        return 'hover'
    if not any(np.isfinite(flight.noise[6:12]).all() for flight in flights):
        return 'pose'
    more = any(np.isfinite(flight.noise[12:14]).any() for flight in flights)
    return 'all' if more else 'imu'


def _is_hover(flight: MeasuredFlight) -> bool:
    """Tell whether a flight stays about where it is, as far as it is to be explained."""
    place = flight.position[flight.usable]
    if len(place) < 2:
        return True
    speed = np.linalg.norm(np.diff(place[::25], axis=0), axis=1)
    low, high = np.quantile(place[:, 2], [0.1, 0.9])
    slow = len(speed) == 0 or float(np.quantile(speed, 0.9)) < STILL
    return bool(slow and high - low < LEVEL)
