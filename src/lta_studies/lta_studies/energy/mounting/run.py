# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare panel mounts: weight, swing, flight and light."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain, islice
import math
from operator import attrgetter
from typing import Any, Final, final, NamedTuple

from lta_config.command_line import format_lta_command, relative_path
from lta_config.files import find_file, load_yaml
from lta_report.report import Report
from lta_report.request import Names, option, StudyRequest, StudyRun, VEHICLE
from lta_report.study import hash_inputs, Study
from lta_report.study_store import StoreFormat
from lta_studies.energy.mounting.mounted_vehicle import (
    build_mounted_vehicle,
    compute_light_shares,
    lift_deficit,
    LIGHT_DIRECTIONS,
    LightDirection,
    MountedVehicle,
    PanelLightShares,
    required_volume_factor,
)
from lta_studies.energy.mounting.straight_flight import (
    fly_straight,
    MOUNTING_SCENE,
    Release,
    simulate_release,
    StraightFlightResult,
    tilt_growth_rate,
)
from lta_vehicle.figures.stability import compute_pendulum_mode, PendulumMode
from pydantic import TypeAdapter

RELEASE_TILT = math.radians(5.0)  # at the release
SWING_DURATION = 20.0  # s simulated after a release
PAPER_SWING = math.radians(2.5)  # the seed paper's pitch oscillation of the side mount


@final
@dataclass(frozen=True, slots=True)
class MountTrial:
    """A mount in a hull, with its flights."""

    fitted: MountedVehicle
    swing: PendulumMode  # analytical swing, linearised at 5 degrees
    release: Release  # simulated release at 5 degrees
    flights: Sequence[StraightFlightResult]  # one flight per seed

    @property
    def misplacement(self) -> float:
        """Misplacement of the panels that would cause the paper's swing [m]."""
        body = self.fitted.vehicle
        panels = sum(self.fitted.mount.parts[name].mass.si for name in self.fitted.mount.panels)
        # Moving the panels by d moves the centre of gravity by d panels / mass.
        return -body.mass * float(body.cg[2]) * math.tan(PAPER_SWING) / panels


@final
@dataclass(frozen=True, slots=True)
class Overturning:
    """A release at a height of the centre of gravity; `growth` (linearised) only above."""

    height: float  # [m]
    release: Release
    growth: float | None  # [1/s]


@final
@dataclass(frozen=True, slots=True)
class MountingStudy:
    """Comparison of mounts."""

    vehicle: str  # name of the vehicle
    ahead: float  # misplacement of the panels in `misplaced` [m]
    fuller: float  # volume of the hull that carries every mount, relative to the file [1]
    # Lift that the file's hull lacks, by mount; negative if there is spare lift [kg]
    lacking: Mapping[str, float]
    # Trials by mount: in the file's hull (if that carries it), in the hull that carries all
    # mounts, and in that hull with misplaced panels
    own: Mapping[str, MountTrial]
    shared: Mapping[str, MountTrial]
    misplaced: Mapping[str, MountTrial]
    # The centre of gravity below, at and above the centre of buoyancy
    overturning: Sequence[Overturning]
    light: Mapping[str, Mapping[str, PanelLightShares]]  # shares of light by mount and light


@final
class MountingRequest(StudyRequest, command='energy mounting', quick={'seeds': 1}):
    """
    Compare solar panels mounted at the side, at the bottom and on top.

    A mount is a file in config/mounts: parts that replace a layer, some of them panels. Mass,
    balance, inertia, drag and shading follow from it. Each variant is released tilted, checked
    against a closed-form solution, and flown straight at 0.1 m/s with panels in place and
    misplaced. If the hull cannot carry a mount, all variants are compared in a fuller hull. The
    page also shows the effect of a centre of gravity above the centre of buoyancy.

    Writes a page, mounting.json (SI units) and a vehicle file for each variant.

    Exit status 0: done. 2: bad input.

    Example: lta energy mounting --seeds 1
    """

    mount: Names = option(
        'Solar panel mount, name or file; repeat to compare several.',
        default=('side', 'bottom', 'top'),
    )
    vehicle: str = VEHICLE
    misplaced: float = option(
        'Forward displacement of the panels in the misplaced variant, in cm; negative: backward.',
        default=3.0, low=-50.0, high=50.0,
    )  # fmt: skip
    seeds: int = option('Number of flights with each mount.', default=3, low=1, high=100)

    def run(self, run: StudyRun) -> Report:
        """Return the report of all mounts."""
        from lta_studies.energy.mounting.report import build_report, find_best_mount

        # cm to m; the raw file, because mounts replace one of its layers
        content = load_yaml(find_file('vehicle', self.vehicle))
        variants = MountVariants(content, self.mount, self.misplaced / 100.0, self.seeds)
        vehicles = chain(*variants.build_vehicles().values())
        scene = load_yaml(find_file('scenario', MOUNTING_SCENE))
        identity = hash_inputs(scene, *(each.content for each in vehicles))
        flying = Study(fly_mount, attrgetter('key'), MOUNTING_STORE, 'flights')
        study = compare_mounts(variants, partial(run.run_study, flying, identity))
        best = relative_path(run.folder / f'{find_best_mount(study)}.yaml')
        commands = {
            'Compare with the vehicle': format_lta_command('vehicle', 'diff', self.vehicle, best),
            'Fly it': format_lta_command('simulate', '--vehicle', best),
        }
        return build_report(study, commands)


@final
@dataclass(frozen=True, slots=True)
class MountVariants:
    """Content of a vehicle file, mounts, misplacement [m], number of seeds, first one."""

    content: Mapping[str, Any]
    mounts: Sequence[str]
    ahead: float
    seeds: int
    first: int = 1

    def build_vehicles(self) -> dict[str, list[MountedVehicle]]:
        """Build all vehicles by group; raise `BadInput` if one cannot be built."""
        fuller = required_volume_factor(self.content, self.mounts)
        # 1e-9 kg absorbs rounding for a mount that just fits.
        able = [name for name in self.mounts if lift_deficit(self.content, name) <= 1e-9]
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


class MountFlight(NamedTuple):
    """One flight of a mount in a hull; `group` as in `MountVariants.build_vehicles`."""

    group: str
    mounted: MountedVehicle
    seed: int

    @property
    def key(self) -> str:
        """Name in the store."""
        return f'{self.group} {self.mounted.mount.name}, seed {self.seed}'


MOUNTING_STORE: Final = StoreFormat(
    'flights.jsonl',
    'mounting',
    'comparison of mounts',
    TypeAdapter(StraightFlightResult),
)


def fly_mount(flight: MountFlight) -> StraightFlightResult:
    """Fly a mount straight ahead."""
    return fly_straight(flight.mounted, find_gains_name(flight.mounted), flight.seed)


def evaluate_mount(mounted: MountedVehicle, flights: Sequence[StraightFlightResult]) -> MountTrial:
    """Evaluate a mount: analytical swing, release, and flights."""
    body = mounted.vehicle
    return MountTrial(
        mounted,
        compute_pendulum_mode(body, 'pitch'),
        simulate_release(body, RELEASE_TILT, SWING_DURATION),
        flights,
    )


def find_gains_name(mounted: MountedVehicle) -> str:
    """Return the name of the vehicle's own gains; '' if it names none."""
    return str(mounted.content.get('control', {}).get('gains', ''))


def simulate_overturning(mounted: MountedVehicle) -> list[Overturning]:
    """Simulate releases with the centre of gravity below, at and above the hull centre."""
    depth = -float(mounted.vehicle.cg[2])
    inertia = compute_pendulum_mode(mounted.vehicle, 'pitch').inertia
    rate = tilt_growth_rate(mounted.vehicle, depth, inertia)
    return [
        Overturning(
            height, simulate_release(mounted.vehicle, RELEASE_TILT, SWING_DURATION, height), fast
        )
        for height, fast in ((-depth, None), (0.0, None), (depth, rate))
    ]


def compute_panel_light(
    mounted: MountedVehicle, lights: Sequence[LightDirection] = LIGHT_DIRECTIONS
) -> dict[str, PanelLightShares]:
    """Compute the light on the panels of a mount, by name of the light."""
    return {
        light.name: compute_light_shares(mounted.vehicle, mounted.mount, light) for light in lights
    }


FLY_MOUNTS_HERE: Final = partial(map, fly_mount)


def compare_mounts(
    request: MountVariants,
    fly_all: Callable[[Sequence[MountFlight]], Iterable[StraightFlightResult]] = FLY_MOUNTS_HERE,
) -> MountingStudy:
    """Compare the mounts; `fly_all` flies all flights, in this process or in workers."""
    fits = request.build_vehicles()
    seeds = range(request.first, request.first + request.seeds)
    flights = [
        MountFlight(group, each, seed)
        for group, vehicles in fits.items() for each in vehicles for seed in seeds
    ]  # fmt: skip
    results = iter(fly_all(flights))
    own, shared, misplaced = (
        {
            each.mount.name: evaluate_mount(each, list(islice(results, request.seeds)))
            for each in fits[group]
        }
        for group in ('own', 'shared', 'misplaced')
    )
    # If the hull carries no mount, use the larger hull.
    first = (own or shared).values()
    return MountingStudy(
        vehicle=str(request.content['name']),
        ahead=request.ahead,
        fuller=required_volume_factor(request.content, request.mounts),
        lacking={
            name: lift_deficit(request.content, mount)
            for name, mount in zip(shared, request.mounts, strict=True)
        },
        own=own,
        shared=shared,
        misplaced=misplaced,
        overturning=simulate_overturning(list(first)[-1].fitted),
        light={name: compute_panel_light(each.fitted) for name, each in shared.items()},
    )
