"""The whole comparison of mounts: what each weighs, how it swings, how it flies, what it gets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any, final

from lta_studies.energy.mounting.fitted import carrying, fit, Fitted, lacking
from lta_studies.energy.mounting.lit import Light, LIGHTS, Lit, lit
from lta_studies.energy.mounting.released import growth, Release, released
from lta_studies.energy.mounting.straight import Straight, straight
from lta_vehicle.figures.swing import Swing, swing

TILT = math.radians(5.0)  # at which it is let go
LOOK = 20.0  # s, how long a released vehicle is watched
PAPER_SWING = math.radians(2.5)  # the seed paper's pitch oscillation of the side mount


@final
@dataclass(frozen=True, slots=True)
class Tried:
    """
    A mount in a hull, with its flights.

    Attributes
    ----------
    fitted : Fitted
        The vehicle.
    swing : Swing
        By hand, linearised at 5 degrees.
    release : Release
        By the simulator's kernel, let go at 5 degrees.
    flights : sequence of Straight
        By seed.

    """

    fitted: Fitted
    swing: Swing
    release: Release
    flights: Sequence[Straight]

    @property
    def misplacement(self) -> float:
        """How far out of place the panels must sit for the paper's swing. [m]"""
        body = self.fitted.vehicle
        panels = sum(self.fitted.mount.parts[name].mass.si for name in self.fitted.mount.panels)
        return -body.mass * float(body.cg[2]) * math.tan(PAPER_SWING) / panels


@final
@dataclass(frozen=True, slots=True)
class Overturning:
    """A release with the centre of gravity at a height; growth is linearised, above alone."""

    height: float  # [m]
    release: Release
    growth: float | None  # [1/s]


@final
@dataclass(frozen=True, slots=True)
class Study:
    """
    All of it.

    Attributes
    ----------
    vehicle : str
        Name of the vehicle.
    ahead : float
        How far out of place the panels of the misplaced ones sit. [m]
    fuller : float
        Volume of the hull that carries every mount, by the file's. [1]
    lacking : mapping
        Lift that the file's own hull lacks, by mount; negative is to spare. [kg]
    own, shared, misplaced : mapping
        By mount: in the file's hull (where that carries it), in the hull that carries all, and in
        that hull with the panels out of place.
    overturning : sequence of Overturning
        The centre of gravity below, at and above the centre of buoyancy.
    light : mapping
        By mount: what falls on the panels, by name of the light.

    """

    vehicle: str
    ahead: float
    fuller: float
    lacking: Mapping[str, float]
    own: Mapping[str, Tried]
    shared: Mapping[str, Tried]
    misplaced: Mapping[str, Tried]
    overturning: Sequence[Overturning]
    light: Mapping[str, Mapping[str, Lit]]


@final
@dataclass(frozen=True, slots=True)
class Order:
    """What to compare: a vehicle file's content, mounts, a misplacement [m], and seeds."""

    content: Mapping[str, Any]
    mounts: Sequence[str]
    ahead: float
    seeds: int

    def fits(self) -> dict[str, list[Fitted]]:
        """Return all that will fly, by group; `BadInput` where something cannot be."""
        fuller = carrying(self.content, self.mounts)
        able = [name for name in self.mounts if lacking(self.content, name) <= 1e-9]
        return {
            'own': [fit(self.content, name) for name in able],
            'shared': [fit(self.content, name, fuller=fuller) for name in self.mounts],
            'misplaced': [fit(self.content, name, self.ahead, fuller) for name in self.mounts],
        }


def tried(fitted: Fitted, seeds: int, tick: Callable[[], None]) -> Tried:
    """Return what a mount came to, by hand, let go, and flown."""
    flights = []
    for seed in range(1, seeds + 1):
        flights.append(straight(fitted, gains_of(fitted), seed))
        tick()
    body = fitted.vehicle
    return Tried(fitted, swing(body, 'pitch'), released(body, TILT, LOOK), flights)


def gains_of(fitted: Fitted) -> str:
    """Return the name of the vehicle's own gains; '' where it names none."""
    return str(fitted.content.get('control', {}).get('gains', ''))


def overturning(fitted: Fitted) -> list[Overturning]:
    """Return releases with the centre of gravity below, at and above the hull's centre."""
    depth = -float(fitted.vehicle.cg[2])
    inertia = swing(fitted.vehicle, 'pitch').inertia
    rate = growth(fitted.vehicle, depth, inertia)
    return [
        Overturning(height, released(fitted.vehicle, TILT, LOOK, height), fast)
        for height, fast in ((-depth, None), (0.0, None), (depth, rate))
    ]


def light_on(fitted: Fitted, lights: Sequence[Light] = LIGHTS) -> dict[str, Lit]:
    """Return what falls on the panels of a mount, by name of the light."""
    return {light.name: lit(fitted.vehicle, fitted.mount, light) for light in lights}


def study(order: Order, tick: Callable[[], None]) -> Study:
    """Return the comparison; `tick` is called after each flight."""
    fits = order.fits()
    own, shared, misplaced = (
        {each.mount.name: tried(each, order.seeds, tick) for each in fits[group]}
        for group in ('own', 'shared', 'misplaced')
    )
    first = (own or shared).values()
    return Study(
        vehicle=str(order.content['name']),
        ahead=order.ahead,
        fuller=carrying(order.content, order.mounts),
        lacking={
            name: lacking(order.content, given)
            for name, given in zip(shared, order.mounts, strict=True)
        },
        own=own,
        shared=shared,
        misplaced=misplaced,
        overturning=overturning(list(first)[-1].fitted),
        light={name: light_on(each.fitted) for name, each in shared.items()},
    )
