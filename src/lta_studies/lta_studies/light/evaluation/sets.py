"""The sets of flights of the evaluation: which sweep each is, and along what it is looked at."""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.errors import unknown_name
from lta_config.quantity import Quantity
from lta_flight.flight_spec import FlightSpec


@final
@dataclass(frozen=True, slots=True)
class EvaluationAxis:
    """
    What a set varies, as a number of each flight.

    Attributes
    ----------
    title, unit : str
        On the axis of a picture.
    place : callable
        `place(made_of) -> float`, in the unit.
    decades : bool
        Whether it spans decades.

    """

    title: str
    unit: str
    place: Callable[[FlightSpec], float]
    decades: bool = False


@final
@dataclass(frozen=True, slots=True)
class FlightSet:
    """
    A sweep of the evaluation.

    Attributes
    ----------
    file : str
        Sweep file; it varies `strategy`.
    title, about : str
        For people.
    axis : Axis or None
        What it is looked at along; None where its cases only have names.
    piloted : bool
        Whether the reference pilot flies it too.

    """

    file: str
    title: str
    about: str
    axis: EvaluationAxis | None = None
    piloted: bool = True


def read_quantity(spec: FlightSpec, path: str) -> tuple[float, ...]:
    """Return the numbers that stand at a path, in SI."""
    return Quantity.model_validate(spec.read_value(path)).vector


def lamp_distance(spec: FlightSpec) -> float:
    """Return how far the lamp is at the start. [m]"""
    x, y = read_quantity(spec, 'scenario.start.position')
    there = read_quantity(spec, 'scenario.lamp.position')
    return math.hypot(there[0] - x, there[1] - y)


def reference_wind(spec: FlightSpec) -> float:
    """Return the wind at the reference height. [m/s]"""
    return read_quantity(spec, 'scenario.air.profile.wind')[0]


def ground_roughness(spec: FlightSpec) -> float:
    """Return the roughness of the ground. [m]"""
    return read_quantity(spec, 'scenario.air.profile.roughness')[0]


def uniform_wind(spec: FlightSpec) -> float:
    """Return the mean wind. [m/s]"""
    return math.hypot(*read_quantity(spec, 'scenario.air.wind'))


def ambient_light(spec: FlightSpec) -> float:
    """Return the steady ambient light. [lx]"""
    return read_quantity(spec, 'scenario.ambient.steady')[0]


INDOORS: Final = 'indoors'
WINDS: Final = 'winds'
ROUGHNESS: Final = 'roughness'
UNIFORM: Final = 'uniform'
ABLATIONS: Final = 'ablations'
SETS: Final[dict[str, FlightSet]] = {
    INDOORS: FlightSet(
        'light_indoors', 'Indoors, from 7 m',
        'The paper\'s indoor flight: 7 m, 0.5 m/s, 0.5 m up, reached within 1 m; any heading.',
    ),
    WINDS: FlightSet(
        'light_reference_winds', 'Against reference winds',
        'Wind at 10 m over a roughness of 0.3 m, from the lamp to the start; told to fly 1 m/s.',
        EvaluationAxis('wind at 10 m', 'm/s', reference_wind),
    ),
    ROUGHNESS: FlightSet(
        'light_roughness', 'The same 8 m/s over other ground',
        'The paper names no roughness; so near the ground it decides what the hull meets.',
        EvaluationAxis('roughness', 'm', ground_roughness),
    ),
    UNIFORM: FlightSet(
        'light_uniform_winds', 'In uniform wind',
        'Mean plus one standard deviation up to 0.9 of the airspeed that the vehicle can fly.',
        EvaluationAxis('mean wind', 'm/s', uniform_wind),
    ),
    'range': FlightSet(
        'light_range', 'From 2 to 15 m', 'On an open field in still air.',
        EvaluationAxis('distance', 'm', lamp_distance), piloted=False,
    ),
    'ambient': FlightSet(
        'light_ambient', 'From dark to full sun', 'From 7 m, on an open field in still air.',
        EvaluationAxis('ambient light', 'lx', ambient_light, decades=True), piloted=False,
    ),
    'door': FlightSet(
        'light_door', 'Out of a building',
        'At the door wind and sunlight step; the lamp stands 3 m outside.',
    ),
    ABLATIONS: FlightSet(
        'light_ablations', 'What makes the order',
        'Indoors, one factor changed at a time, the seeds the same.', piloted=False,
    ),
}  # fmt: skip


def find_flight_set(name: str) -> FlightSet:
    """Return a set; an unknown name is a `BadInput` that lists the known ones."""
    if name not in SETS:
        raise unknown_name('set', name, list(SETS))
    return SETS[name]
