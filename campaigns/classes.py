# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Derive which effects no data of a kind can tell apart.

With `--write`, writes `classes.yaml` and its page. Without, it is wrong if the stored classes are
not those that are derived now. Two effects are equivalent if their columns, marginal over all
else, have a cosine of 0.98 or more: the evidence between two effects of z deviations is
z^2 (1 - 0.98^2) / 2 nats, which reaches 3 nats only at z = 12.
"""

from argparse import Namespace
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Final

from lta_config.files import load_file, StrictModel
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_model.vehicle import load_vehicle
from pydantic import Field
import yaml

from campaigns import class_derivation
from campaigns.class_derivation import EffectSeparability
from campaigns.harness import Campaign, Case, Row, Rows

TABLE = Path(__file__).with_name('classes.yaml')
NEAR = 0.9  # of a cosine, from which a pair is listed
TOLD = {
    'all': 'pose, IMU, range, pressure and voltage; rich flights',
    'imu': 'pose and IMU; rich flights',
    'pose': 'pose alone; rich flights',
    'wrench': 'pose alone, commands as a body wrench; rich flights',
    'hover': 'all sensors; hover alone',
}


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
def load_class_map(kind: str = 'all') -> Mapping[str, str]:
    """Return the class of each effect for a kind of data: the first effect of its class."""
    classes = load_file(FrozenClasses, TABLE).kinds[kind]
    # Effects outside any class represent themselves
    out = {name: name for name in classes.reach}
    return out | {name: group[0] for group in classes.classes for name in group}


def summarize_kind(found: EffectSeparability) -> DataKindClasses:
    """Return what is kept of a kind."""
    seen = [k for k, reach in enumerate(found.reach) if reach >= class_derivation.SEEN]
    groups = found.list_equivalence_classes()
    group = {name: n for n, names in enumerate(groups) for name in names}
    near: dict[str, float] = {}
    for i in seen:
        for j in seen:
            a, b, cosine = found.names[i], found.names[j], float(found.cosine[i, j])
            if i < j and cosine >= NEAR and not (a in group and group.get(b) == group[a]):
                near[f'{a}, {b}'] = round(cosine, 3)
    return DataKindClasses(
        classes=groups,
        unseen=found.unobservable_effects,
        near=dict(sorted(near.items(), key=lambda pair: -pair[1])),
        reach={
            name: [float(f'{reach:.2g}'), float(f'{cap:.2g}')]
            for name, reach, cap in zip(found.names, found.reach, found.cap, strict=True)
        },
    )


def derive() -> FrozenClasses:
    """Return all that is kept."""
    known = class_derivation.select_builtin_parameters(
        list_free_parameters(NominalVehicle.from_vehicle(load_vehicle(class_derivation.VEHICLE)))
    )
    return FrozenClasses(
        digest=class_derivation.compute_registry_digest(known),
        vehicle=class_derivation.VEHICLE,
        threshold=class_derivation.ALIKE,
        flights=class_derivation.FLIGHTS,
        length_s=class_derivation.LENGTH,
        kinds={
            kind: summarize_kind(found)
            for kind, found in class_derivation.derive_classes().items()
        },
    )


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the classes as people read them."""
    found = [row['classes'] for row in rows.values() if 'classes' in row]
    if found:
        yield from list_page(FrozenClasses.model_validate(found[0]))


def list_page(kept: FrozenClasses) -> Iterator[str]:
    """Yield the lines of the page."""
    lines = [
        f'Derived from {kept.flights} simulated flights of {kept.length_s:g} s of '
        f'{kept.vehicle} of each kind, registry {kept.digest}. Of every candidate the part of its '
        'column is taken that is left once states, latent forces and all other parameters within '
        'their tolerances have had their share. Two names are one class where the cosine between '
        f'these parts is {kept.threshold:g} or more, in size: an effect of z deviations is then '
        'told from the other by z² (1 - cosine²) / 2 nats, less than the 3 nats that a name needs '
        'until z is 12. Classes are frozen before anything is scored by them.',
        '',
    ]
    for kind, found in kept.kinds.items():
        lines += [f'## {kind}: {TOLD[kind]}', '', 'One name to such data:', '']
        lines += [f'- {", ".join(f"`{name}`" for name in group)}' for group in found.classes]
        near = '; '.join(f'{_names(pair)} {cosine:.2f}' for pair, cosine in found.near.items())
        lines += ['', f'Told apart only when large (cosine from {NEAR:g}): {near or "none"}.', '']
    lines += [
        '## How far a typical effect stands out',
        '',
        'Deviations of a typical size (the spread that the registry declares), the tolerances of '
        'the vehicle file among them: in these flights, and at most, with all sensors and however '
        'long they are. What stays below 6 there is capped by its own tolerance: only a better '
        'known vehicle would show it, or an effect that is larger than typical. A dash: not seen '
        'at all.',
        '',
        '| name | ' + ' | '.join(kept.kinds) + ' | at most |',
        '|' + '---|' * (2 + len(kept.kinds)),
    ]
    kinds = [*kept.kinds.values()]
    for name in kinds[0].reach:
        cells = [_cell(found.reach[name][0]) for found in kinds]
        cells.append(_cell(kinds[0].reach[name][1]))
        lines.append(f'| `{name}` | ' + ' | '.join(cells) + ' |')
    yield from lines


def _names(pair: str) -> str:
    """Return two names as code."""
    return ' and '.join(f'`{name}`' for name in pair.split(', '))


def _cell(number: float) -> str:
    """Return deviations as people read them."""
    if number < class_derivation.SEEN:
        return '-'
    return '> 100' if number > 100.0 else f'{number:.2g}'


def run(case: Case, options: Namespace) -> Row:
    """Derive the classes, and store or compare them."""
    now = derive()
    if options.write:
        head = '# Derived by `make campaign classes`; not to be edited.\n'
        data = now.model_dump()
        TABLE.write_text(
            head + yaml.safe_dump(data, sort_keys=False, width=120, default_flow_style=None)
        )
    before = load_file(FrozenClasses, TABLE)
    same = {kind: one.classes for kind, one in before.kinds.items()} == {
        kind: one.classes for kind, one in now.kinds.items()
    } and before.digest == now.digest
    wrong = '' if same else 'not as derived: run make campaign classes ARGS=--write'
    return {'classes': now.model_dump(), 'wrong': wrong}


CAMPAIGN: Final = Campaign(lambda options: ['all'], run, list_table, page='discovery_classes.md')
