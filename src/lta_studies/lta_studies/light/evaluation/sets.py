"""Define the flight sets of the evaluation: sweep file, title and axis."""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.errors import unknown_name_error
from lta_config.quantity import Quantity
from lta_flight.flight_spec import FlightSpec


@final
@dataclass(frozen=True, slots=True)
class EvaluationAxis:
    """The quantity that a set varies."""

    # Label of the axis
    title: str
    unit: str
    place: Callable[[FlightSpec], float]  # returns the value of a flight spec in the unit
    decades: bool = False  # whether the values span decades


@final
@dataclass(frozen=True, slots=True)
class FlightSet:
    """A sweep of the evaluation."""

    file: str  # sweep file; it must vary `strategy`
    # Title and description on the page
    title: str
    about: str
    axis: EvaluationAxis | None = None  # axis of the plot; None if the cases only have names
    piloted: bool = True  # whether the reference pilot also flies it


def read_si_values(spec: FlightSpec, path: str) -> tuple[float, ...]:
    """Return the numbers at a path, in SI units."""
    return Quantity.model_validate(spec.read_value(path)).vector


def lamp_distance(spec: FlightSpec) -> float:
    """Return the distance from start to lamp. [m]"""
    # Horizontal distance; the start has no height of its own.
    x, y = read_si_values(spec, 'scenario.start.position')
    there = read_si_values(spec, 'scenario.lamp.position')
    return math.hypot(there[0] - x, there[1] - y)


def reference_wind(spec: FlightSpec) -> float:
    """Return the wind at the reference height. [m/s]"""
    return read_si_values(spec, 'scenario.air.profile.wind')[0]


def ground_roughness(spec: FlightSpec) -> float:
    """Return the roughness of the ground. [m]"""
    return read_si_values(spec, 'scenario.air.profile.roughness')[0]


def uniform_wind(spec: FlightSpec) -> float:
    """Return the mean wind. [m/s]"""
    return math.hypot(*read_si_values(spec, 'scenario.air.wind'))


def ambient_light(spec: FlightSpec) -> float:
    """Return the steady ambient light. [lx]"""
    return read_si_values(spec, 'scenario.ambient.steady')[0]


INDOORS: Final = 'indoors'
WINDS: Final = 'winds'
ROUGHNESS: Final = 'roughness'
UNIFORM: Final = 'uniform'
ABLATIONS: Final = 'ablations'
SETS: Final[dict[str, FlightSet]] = {
    INDOORS: FlightSet(
        'light_indoors', 'Indoors, from 7 m',
        "The paper's indoor flight: 7 m to the lamp at 0.5 m/s and 0.5 m altitude, from "
        'any heading. The lamp counts as reached within 1 m.',
    ),
    WINDS: FlightSet(
        'light_reference_winds', 'Against reference winds',
        'The wind is given at 10 m height over ground with a roughness of 0.3 m; it '
        'blows from the lamp to the start. The airspeed command is 0.7 m/s.',
        EvaluationAxis('wind at 10 m', 'm/s', reference_wind),
    ),
    ROUGHNESS: FlightSet(
        'light_roughness', 'In a wind of 8 m/s over other ground',
        'The paper does not state the roughness of the ground, which determines the '
        'wind at the height of the hull.',
        EvaluationAxis('roughness', 'm', ground_roughness),
    ),
    UNIFORM: FlightSet(
        'light_uniform_winds', 'In uniform wind',
        'The mean wind plus one standard deviation is up to 0.9 of the airspeed that '
        'the vehicle can fly.',
        EvaluationAxis('mean wind', 'm/s', uniform_wind),
    ),
    'range': FlightSet(
        'light_range', 'From a distance of 2 to 15 m', 'To a lamp on an open field in still air.',
        EvaluationAxis('distance', 'm', lamp_distance), piloted=False,
    ),
    'ambient': FlightSet(
        'light_ambient', 'From dark to full sun',
        'From a distance of 7 m, on an open field in still air.',
        EvaluationAxis('ambient light', 'lx', ambient_light, decades=True), piloted=False,
    ),
    'door': FlightSet(
        'light_door', 'Out of a building',
        'From inside a building to a lamp 3 m outside; wind and sunlight change at the door.',
    ),
    ABLATIONS: FlightSet(
        'light_ablations', 'One factor changed at a time',
        'Indoors, one factor changed at a time, with the same seeds.', piloted=False,
    ),
}  # fmt: skip


def find_flight_set(name: str) -> FlightSet:
    """Return a set; raise `BadInput` for an unknown name."""
    if name not in SETS:
        raise unknown_name_error('set', name, list(SETS))
    return SETS[name]
