# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare panel mounts: weight, swing, flight and light."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any, final

from lta_studies.energy.mounting.mounted_vehicle import (
    build_mounted_vehicle,
    compute_light_shares,
    lift_deficit,
    LIGHT_DIRECTIONS,
    MountedVehicle,
    PanelLightShares,
    required_volume_factor,
)
from lta_studies.energy.mounting.straight_flight import (
    fly_straight,
    Release,
    simulate_release,
    StraightFlightResult,
)
from lta_vehicle.figures.stability import compute_pendulum_mode, PendulumMode

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
    """A release at a height of the centre of gravity."""

    height: float  # [m]
    release: Release


@final
@dataclass(frozen=True, slots=True)
class MountingStudy:
    """Comparison of mounts."""

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
    return [
        Overturning(
            height, simulate_release(mounted.vehicle, RELEASE_TILT, SWING_DURATION, height)
        )
        for height in (-depth, 0.0, depth)
    ]


def compute_panel_light(mounted: MountedVehicle) -> dict[str, PanelLightShares]:
    """Compute the light on the panels of a mount, by name of the light."""
    return {
        light.name: compute_light_shares(mounted.vehicle, mounted.mount, light)
        for light in LIGHT_DIRECTIONS
    }


def compare_mounts(request: MountVariants) -> MountingStudy:
    """Fly each mount straight ahead with every seed, and compare them."""
    fits, seeds = request.build_vehicles(), range(request.first, request.first + request.seeds)
    own, shared, misplaced = (
        {
            each.mount.name: evaluate_mount(
                each, [fly_straight(each, find_gains_name(each), seed) for seed in seeds]
            )
            for each in fits[group]
        }
        for group in ('own', 'shared', 'misplaced')
    )
    # If the hull carries no mount, use the larger hull.
    first = (own or shared).values()
    return MountingStudy(
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
