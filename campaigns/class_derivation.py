# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Derive which effects are indistinguishable for a kind of data, from rich flights of each kind.

Rich flights vary height, heading and speed and dither the motors; `hover` flights do not. Effects
that these flights cannot separate are not separable by other data of the kind.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import hashlib
from typing import Any, Final, final

from lta_discovery.flights.measured_flight import FlightStreams
from lta_discovery.lab_tests.rehearsal import measure_information
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec, load_spec
from lta_model.effects import BUILT_IN, EFFECTS
import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage

from campaigns.rich_flights import measure_rehearsal, Sensors, simulate_flight, with_course
from campaigns.separability import PairSeparability

Array = NDArray[np.float64]

VEHICLE: Final = 'gtmab'
# |cosine| of equivalent effects: see `campaigns.classes`
ALIKE: Final = 0.98
SEEN: Final = 0.1  # significance of a typical size, below which an effect is unobservable
FLIGHTS: Final = 3
LENGTH: Final = 120.0  # s
MORE: Final = 1e4  # times as long, to find the limit set by tolerances
LEG: Final = 6.0  # s
# Kinds of data: the sensors, and whether the flights are rich.
KINDS: Final[dict[str, tuple[Sensors, bool]]] = {
    'all': ('all', True),
    'imu': ('imu', True),
    'pose': ('pose', True),
    'wrench': ('wrench', True),
    'hover': ('all', False),
}


@final
@dataclass(frozen=True, slots=True)
class EffectSeparability:
    """Separability of effects for one kind of data."""

    names: tuple[str, ...]
    cosine: Array  # |cosine| of each pair, shape (n, n)
    # Significance of a typical size: for these flights, and for unlimited length, shape (n,)
    reach: Array
    cap: Array

    @property
    def unobservable_effects(self) -> list[str]:
        """Unobservable effects."""
        return [name for name, s in zip(self.names, self.reach, strict=True) if s < SEEN]

    def list_equivalence_classes(self) -> list[list[str]]:
        """Return the classes of equivalent effects with more than one member."""
        seen = np.flatnonzero(self.reach >= SEEN)
        if len(seen) < 2:
            return []
        labels = cluster_complete_linkage(self.cosine[np.ix_(seen, seen)], ALIKE)
        groups = [[self.names[seen[k]] for k in group] for group in labels]
        return [group for group in groups if len(group) > 1]


def cluster_complete_linkage(cosine: Array, least: float) -> list[list[int]]:
    """Group by complete linkage: every two members are alike."""
    far = 1.0 - np.abs(cosine)
    # The order that scipy's linkage expects
    condensed = far[np.triu_indices(len(far), 1)]
    label = fcluster(linkage(np.maximum(condensed, 0.0), 'complete'), 1.0 - least, 'distance')
    groups: dict[int, list[int]] = {}
    for k, one in enumerate(label):
        groups.setdefault(int(one), []).append(k)
    return sorted(groups.values())


def build_rich_course(seed: int, rich: bool) -> dict[str, Any]:
    """Return a course of `LENGTH` in the format of a scenario file."""
    rng = np.random.default_rng([seed, 21])
    rows, heading, at = [], 0.0, 2.0
    while at < LENGTH - LEG:
        heading += float(rng.uniform(-2.0, 2.0)) if rich else 0.0
        low = float(rng.uniform(0.5, 0.7) if rng.random() < 0.3 else rng.uniform(0.7, 2.0))
        rows.append(
            {
                'at': {'value': at, 'unit': 's'},
                'altitude': {'value': low if rich else 1.2, 'unit': 'm'},
                'heading': {'value': heading, 'unit': 'rad'},
                'speed': {
                    'value': float(rng.choice([0.0, 0.3, 0.6, 0.9])) if rich else 0.0,
                    'unit': 'm/s',
                },
            }
        )
        at += LEG
    shake = {'duty': {'value': 0.25, 'unit': '1'}, 'hold': {'value': 0.7, 'unit': 's'}}
    return {'between': 'step', 'rows': rows, **({'shake': shake} if rich else {})}


def derive_classes(
    kinds: Sequence[str] = tuple(KINDS), flights: int = FLIGHTS
) -> Mapping[str, EffectSeparability]:
    """Derive the separability for each kind of data."""
    spec = load_spec(VEHICLE, 'hall', 'bag', '')
    vehicle = build_vehicle_scenario_stack(spec)[0]
    turned = select_builtin_parameters(list_free_parameters(NominalVehicle.from_vehicle(vehicle)))
    out: dict[str, EffectSeparability] = {}
    simulated = {}
    for kind in kinds:
        sensors, rich = KINDS[kind]
        # Kinds share the simulated flights; only the recorded sensors differ
        if rich not in simulated:
            simulated[rich] = [
                _simulate_streams(spec, seed, rich) for seed in range(1, flights + 1)
            ]
        nominal = NominalVehicle.from_vehicle(vehicle)
        reduced = [
            measure_information(
                measure_rehearsal(streams, vehicle, sensors), vehicle, nominal, turned
            )
            for streams in simulated[rich]
        ]
        out[kind] = compare_candidates(
            PairSeparability(reduced, turned), PairSeparability(reduced, turned, MORE)
        )
    return out


def _simulate_streams(spec: FlightSpec, seed: int, rich: bool) -> FlightStreams:
    """Return the recorded streams of a simulated flight."""
    vehicle, scenario, policy = build_vehicle_scenario_stack(
        with_course(spec, build_rich_course(seed, rich), LENGTH)
    )
    return simulate_flight(vehicle, scenario, policy, seed)


def compare_candidates(pairs: PairSeparability, more: PairSeparability) -> EffectSeparability:
    """Return cosines and significances of all candidates."""
    at = [k for k, knob in enumerate(pairs.knobs) if knob.typical > 0.0]
    cosine = np.eye(len(at))
    reach = np.array([pairs.detection_sigma(k) for k in at])
    cap = np.array([more.detection_sigma(k) for k in at])
    for i, a in enumerate(at):
        for j in range(i):
            # The cosine of an unobservable effect is only rounding
            if reach[i] >= SEEN and reach[j] >= SEEN:
                cosine[i, j] = cosine[j, i] = abs(pairs.compare_pair(a, at[j]).cosine)
    return EffectSeparability(tuple(pairs.knobs[k].name for k in at), cosine, reach, cap)


def select_builtin_parameters(parameters: Sequence[FreeParameter]) -> list[FreeParameter]:
    """Return the parameters of built-in effects: the frozen classes exclude plug-ins."""
    foreign = set(EFFECTS) - set(BUILT_IN)
    return [knob for knob in parameters if foreign.isdisjoint(effect for effect, _ in knob.moves)]


def compute_registry_digest(parameters: Sequence[FreeParameter]) -> str:
    """Return a digest of the candidates in the registry, 12 hexadecimal digits."""
    digest = hashlib.sha256()
    for knob in parameters:
        moves = sorted((*target, f'{rate:.9g}') for target, rate in knob.moves.items())
        numbers = f'{knob.tolerance:.9g} {knob.typical:.9g} {knob.per_flight}'
        # 9 digits: independent of rounding on other machines
        digest.update(f'{knob.name} {knob.unit} {moves} {numbers}\n'.encode())
    return digest.hexdigest()[:12]
