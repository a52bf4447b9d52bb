"""
Derive which names no data of a kind can tell apart, from rich flights of each kind.

Rich is every excitation at once: heights, headings and speeds that change, and shaken motors; of
`hover`, none. What such flights cannot tell apart, no other data of the kind will.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import hashlib
from typing import Any, Final, final

from lta_discovery.fit.evidence import floor_of, Pieces
from lta_discovery.flights.measured import Streams
from lta_discovery.model.knobs import Knob, knobs
from lta_discovery.model.nominal import Nominal
from lta_discovery.planning.pairs import Pairs
from lta_discovery.planning.rehearsal import along, prepared, rehearse, Sensors
from lta_discovery.replay.linear import origin
from lta_flight.ingredients import gather, Ingredients, parts_of
from lta_model.effects import BUILT_IN, EFFECTS
import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage

Array = NDArray[np.float64]

VEHICLE: Final = 'gtmab'
ALIKE: Final = 0.98  # |cosine| from which two names are one: see `lta_discovery.naming.classes`
SEEN: Final = 0.1  # deviations of a typical size, below which data say nothing of a name
FLIGHTS: Final = 3
LENGTH: Final = 120.0  # s
MORE: Final = 1e4  # times as long: what is left then is capped by tolerances
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
class Derived:
    """
    What one kind of data can tell.

    Attributes
    ----------
    names : tuple of str
        The candidates.
    cosine : ndarray, shape (n, n)
        Of each pair, its size.
    reach, cap : ndarray, shape (n,)
        Deviations that a typical size comes to: in these flights, and however long they are.

    """

    names: tuple[str, ...]
    cosine: Array
    reach: Array
    cap: Array

    @property
    def unseen(self) -> list[str]:
        """Names of which such data say nothing."""
        return [name for name, s in zip(self.names, self.reach, strict=True) if s < SEEN]

    def classes(self) -> list[list[str]]:
        """Return the names that are one, class by class: those with more than one name."""
        seen = np.flatnonzero(self.reach >= SEEN)
        if len(seen) < 2:
            return []
        found = together(self.cosine[np.ix_(seen, seen)], ALIKE)
        groups = [[self.names[seen[k]] for k in group] for group in found]
        return [group for group in groups if len(group) > 1]


def together(cosine: Array, least: float) -> list[list[int]]:
    """
    Return groups in which every two are alike (complete linkage), each in rising order.

    Parameters
    ----------
    cosine : ndarray, shape (n, n)
        Sizes of the cosines.
    least : float
        Of any two in a group.

    """
    far = 1.0 - np.abs(cosine)
    condensed = far[np.triu_indices(len(far), 1)]
    label = fcluster(linkage(np.maximum(condensed, 0.0), 'complete'), 1.0 - least, 'distance')
    groups: dict[int, list[int]] = {}
    for k, one in enumerate(label):
        groups.setdefault(int(one), []).append(k)
    return sorted(groups.values())


def rich_course(seed: int, rich: bool) -> dict[str, Any]:
    """Return a course of `LENGTH` as a scenario file has it."""
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


def derive(kinds: Sequence[str] = tuple(KINDS), flights: int = FLIGHTS) -> Mapping[str, Derived]:
    """Return what each kind of data can tell."""
    made = gather(VEHICLE, 'hall', 'bag', '')
    vehicle = parts_of(made)[0]
    turned = shipped(knobs(Nominal.of(vehicle)))
    out: dict[str, Derived] = {}
    flown = {}
    for kind in kinds:
        sensors, rich = KINDS[kind]
        if rich not in flown:
            flown[rich] = [_streams(made, seed, rich) for seed in range(1, flights + 1)]
        reduced = []
        for streams in flown[rich]:
            flight = prepared(streams, vehicle, turned, sensors)
            nominal = Nominal.of(vehicle)
            linear = flight.at(origin(nominal, turned, flight.replay.cut))
            reduced.append(Pieces(linear).reduced(floor_of(nominal)))
        out[kind] = compared(Pairs(reduced, turned), Pairs(reduced, turned, MORE))
    return out


def _streams(made: Ingredients, seed: int, rich: bool) -> Streams:
    """Return what a flight of the kind would be recorded as."""
    vehicle, scenario, policy = parts_of(along(made, rich_course(seed, rich), LENGTH))
    return rehearse(vehicle, scenario, policy, seed).streams


def compared(pairs: Pairs, more: Pairs) -> Derived:
    """Return what flights say of every two candidates, and of each."""
    at = [k for k, knob in enumerate(pairs.knobs) if knob.typical > 0.0]
    cosine = np.eye(len(at))
    reach = np.array([pairs.sigma(k) for k in at])
    cap = np.array([more.sigma(k) for k in at])
    for i, a in enumerate(at):
        for j in range(i):
            if reach[i] >= SEEN and reach[j] >= SEEN:
                cosine[i, j] = cosine[j, i] = abs(pairs.pair(a, at[j]).cosine)
    return Derived(tuple(pairs.knobs[k].name for k in at), cosine, reach, cap)


def shipped(known: Sequence[Knob]) -> list[Knob]:
    """Return those of the library: what is frozen knows nothing of effects that others install."""
    foreign = set(EFFECTS) - set(BUILT_IN)
    return [knob for knob in known if foreign.isdisjoint(effect for effect, _ in knob.moves)]


def digest(known: Sequence[Knob]) -> str:
    """Return what tells one registry of candidates from another, 12 hexadecimal digits."""
    told = hashlib.sha256()
    for knob in known:
        moves = sorted((*target, f'{rate:.9g}') for target, rate in knob.moves.items())
        numbers = f'{knob.tolerance:.9g} {knob.typical:.9g} {knob.per_flight}'
        told.update(f'{knob.name} {knob.unit} {moves} {numbers}\n'.encode())
    return told.hexdigest()[:12]
