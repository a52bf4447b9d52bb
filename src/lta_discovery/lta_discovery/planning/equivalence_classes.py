"""
Load the classes of effects that are indistinguishable for a kind of data.

`make campaign classes` derives `classes.yaml` from rich flights of each kind (see
`campaigns.class_derivation`), before any scoring. Two effects are equivalent if their
columns, marginal over all else, have a cosine of 0.98 or more. The evidence between two effects of
z deviations is z^2 (1 - 0.98^2) / 2 nats, which reaches the required 3 nats only at z = 12: more
than most effects can have, given the tolerances of a vehicle.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Final, Literal

from lta_config.errors import unknown_name_error
from lta_config.files import load_file, StrictModel
from lta_discovery.flights.measured_flight import MeasuredFlight
import numpy as np
from pydantic import Field

Kind = Literal['all', 'imu', 'pose', 'wrench', 'hover']

CLASSES_FILE: Final = Path(__file__).with_name('classes.yaml')
HOVER_SPEED: Final = 0.15  # m/s; 90 % of a hover flight is slower
HOVER_HEIGHT_RANGE: Final = 0.3  # m; height range of the middle 80 % of a hover flight


class DataKindClasses(StrictModel):
    """
    Distinguishability of effects for one kind of data.

    Attributes
    ----------
    classes : list of list of str
        Equivalent effects; classes of one effect are omitted.
    unseen : list of str
        Unobservable effects.
    near : mapping of str to float
        Cosines of pairs just below the threshold: 'one, other'.
    reach : mapping of str to two numbers
        Significance of a typical size of each effect in standard deviations, with tolerances: for
        the flights of the derivation, and for unlimited length.

    """

    classes: list[list[str]]
    unseen: list[str]
    near: dict[str, float]
    reach: dict[str, Annotated[list[float], Field(min_length=2, max_length=2)]]


class FrozenClasses(StrictModel):
    """Content of the file."""

    digest: Annotated[str, Field(pattern='^[0-9a-f]{12}$')]
    vehicle: str
    threshold: float
    flights: int
    length_s: float
    kinds: dict[str, DataKindClasses]


@cache
def load_frozen_classes() -> FrozenClasses:
    """Load the derived classes."""
    return load_file(FrozenClasses, CLASSES_FILE)


def find_kind_classes(kind: Kind) -> DataKindClasses:
    """Return the classes of a kind of data; raise `BadInput` for an unknown kind."""
    kinds = load_frozen_classes().kinds
    if kind not in kinds:
        raise unknown_name_error('kind of data', kind, list(kinds))
    return kinds[kind]


@cache
def load_class_map(kind: Kind) -> Mapping[str, str]:
    """
    Return the class of each effect for a kind of data: the first effect of its class.

    `kind`: 'all' sensors, 'imu', 'pose' alone, commands as a 'wrench' with pose alone, or 'hover'.
    """
    classes = find_kind_classes(kind)
    out = {name: name for name in classes.reach}
    # Effects outside any class represent themselves
    return out | {name: group[0] for group in classes.classes for name in group}


def is_equivalent(a: str, b: str, kind: Kind) -> bool:
    """Return whether two effects are equivalent; an unknown one is in its own class."""
    class_map = load_class_map(kind)
    return class_map.get(a, a) == class_map.get(b, b)


def classify_data_kind(flights: Sequence[MeasuredFlight]) -> Kind:
    """Return the kind of data of some flights, by the best-instrumented one."""
    # The commanded wrench matters most: it bypasses the effects of the rotors
    if any(flight.wrench is not None for flight in flights):
        return 'wrench'
    if all(_is_hover(flight) for flight in flights):
        return 'hover'
    # Channels 6 to 11 are gyro and accelerometer, 12 and 13 range and pressure
    if not any(np.isfinite(flight.noise[6:12]).all() for flight in flights):
        return 'pose'
    more = any(np.isfinite(flight.noise[12:14]).any() for flight in flights)
    return 'all' if more else 'imu'


def _is_hover(flight: MeasuredFlight) -> bool:
    """Return whether the usable part of a flight stays near one place."""
    place = flight.position[flight.usable]
    if len(place) < 2:
        return True
    # 25 grid periods of 40 ms are 1 s, so distances are speeds in m/s
    speed = np.linalg.norm(np.diff(place[::25], axis=0), axis=1)
    low, high = np.quantile(place[:, 2], [0.1, 0.9])
    slow = len(speed) == 0 or float(np.quantile(speed, 0.9)) < HOVER_SPEED
    return bool(slow and high - low < HOVER_HEIGHT_RANGE)
