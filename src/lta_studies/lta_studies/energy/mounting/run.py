"""The whole comparison of mounts: what each weighs, how it swings, how it flies, what it gets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any, final

from lta_studies.energy.mounting.mounted_vehicle import (
    build_mounted_vehicle,
    lacking_lift,
    MountedVehicle,
    required_fullness,
)
from lta_studies.energy.mounting.panel_light import (
    compute_light_shares,
    LightDirection,
    LIGHTS,
    PanelLightShares,
)
from lta_studies.energy.mounting.release import Release, simulate_release, tilt_growth_rate
from lta_studies.energy.mounting.straight_flight import fly_straight, StraightFlight
from lta_vehicle.figures.pendulum import compute_pendulum_mode, PendulumMode

TILT = math.radians(5.0)  # at which it is let go
LOOK = 20.0  # s, how long a released vehicle is watched
PAPER_SWING = math.radians(2.5)  # the seed paper's pitch oscillation of the side mount


@final
@dataclass(frozen=True, slots=True)
class MountTrial:
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

    fitted: MountedVehicle
    swing: PendulumMode
    release: Release
    flights: Sequence[StraightFlight]

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
class MountingStudy:
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
    own: Mapping[str, MountTrial]
    shared: Mapping[str, MountTrial]
    misplaced: Mapping[str, MountTrial]
    overturning: Sequence[Overturning]
    light: Mapping[str, Mapping[str, PanelLightShares]]


@final
@dataclass(frozen=True, slots=True)
class MountingRequest:
    """What to compare: a vehicle file's content, mounts, a misplacement [m], and seeds."""

    content: Mapping[str, Any]
    mounts: Sequence[str]
    ahead: float
    seeds: int

    def build_vehicles(self) -> dict[str, list[MountedVehicle]]:
        """Return all that will fly, by group; `BadInput` where something cannot be."""
        fuller = required_fullness(self.content, self.mounts)
        able = [name for name in self.mounts if lacking_lift(self.content, name) <= 1e-9]
        return {
            'own': [build_mounted_vehicle(self.content, name) for name in able],
            'shared': [
                build_mounted_vehicle(self.content, name, fuller=fuller) for name in self.mounts
            ],
            'misplaced': [
                build_mounted_vehicle(self.content, name, self.ahead, fuller)
                for name in self.mounts
            ],
        }


def run_trial(mounted: MountedVehicle, seeds: int, tick: Callable[[], None]) -> MountTrial:
    """Return what a mount came to, by hand, let go, and flown."""
    flights = []
    for seed in range(1, seeds + 1):
        flights.append(fly_straight(mounted, find_gains_name(mounted), seed))
        tick()
    body = mounted.vehicle
    return MountTrial(
        mounted, compute_pendulum_mode(body, 'pitch'), simulate_release(body, TILT, LOOK), flights
    )


def find_gains_name(mounted: MountedVehicle) -> str:
    """Return the name of the vehicle's own gains; '' where it names none."""
    return str(mounted.content.get('control', {}).get('gains', ''))


def simulate_overturning(mounted: MountedVehicle) -> list[Overturning]:
    """Return releases with the centre of gravity below, at and above the hull's centre."""
    depth = -float(mounted.vehicle.cg[2])
    inertia = compute_pendulum_mode(mounted.vehicle, 'pitch').inertia
    rate = tilt_growth_rate(mounted.vehicle, depth, inertia)
    return [
        Overturning(height, simulate_release(mounted.vehicle, TILT, LOOK, height), fast)
        for height, fast in ((-depth, None), (0.0, None), (depth, rate))
    ]


def compute_panel_light(
    mounted: MountedVehicle, lights: Sequence[LightDirection] = LIGHTS
) -> dict[str, PanelLightShares]:
    """Return what falls on the panels of a mount, by name of the light."""
    return {
        light.name: compute_light_shares(mounted.vehicle, mounted.mount, light) for light in lights
    }


def compare_mounts(request: MountingRequest, tick: Callable[[], None]) -> MountingStudy:
    """Return the comparison; `tick` is called after each flight."""
    fits = request.build_vehicles()
    own, shared, misplaced = (
        {each.mount.name: run_trial(each, request.seeds, tick) for each in fits[group]}
        for group in ('own', 'shared', 'misplaced')
    )
    first = (own or shared).values()
    return MountingStudy(
        vehicle=str(request.content['name']),
        ahead=request.ahead,
        fuller=required_fullness(request.content, request.mounts),
        lacking={
            name: lacking_lift(request.content, given)
            for name, given in zip(shared, request.mounts, strict=True)
        },
        own=own,
        shared=shared,
        misplaced=misplaced,
        overturning=simulate_overturning(list(first)[-1].fitted),
        light={name: compute_panel_light(each.fitted) for name, each in shared.items()},
    )
