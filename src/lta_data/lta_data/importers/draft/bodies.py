"""Tell the bodies of a tracker apart, and choose the one that is the vehicle."""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import ColumnGroup, Columns
from lta_data.importers.draft.name_hints import KINDS, match_role, parse_column_name
from lta_data.importers.log_table import Numbers
import numpy as np

APART: Final = 0.2  # of their extent; two estimates of one body are closer
STILL: Final = 0.02  # of the largest extent; a body that moves less stands still
HELD: Final = 0.5  # share of repeated values from which a place is a setpoint
KEY: Final = 'body'
# Not the name of a body
COMMON: Final = frozenset([
    *(word for words in KINDS.values() for word in words), 'rigid', 'body', 'marker', 'markers',
    'global', 'world', 'state', 'field', 'header', 'msg', 'data',
])  # fmt: skip


@final
class TrackedBody(NamedTuple):
    """A body: its name, the words of its columns, its positions, and how far it moves."""

    name: str
    words: frozenset[str]
    place: ColumnGroup
    extent: float


def choose_body(
    groups: Sequence[ColumnGroup], table: Columns, choices: DraftChoices
) -> list[ColumnGroup]:
    """
    Return the groups without those of other bodies than the vehicle.

    The only body that moves is the vehicle; of several, the user chooses.
    """
    bodies = _list_bodies(groups, table)
    if len(bodies) < 2:
        return list(groups)
    by_name = {body.name: body for body in bodies}
    largest = max(body.extent for body in bodies)
    options = [
        (body.name, f'{", ".join(body.place.columns)}: moves over {body.extent:.3g}')
        for body in sorted(bodies, key=lambda body: -body.extent)
    ]
    moving = [body for body in bodies if body.extent > STILL * largest]
    if len(moving) == 1 and KEY not in choices.answers:
        chosen, why = choices.override(KEY, moving[0].name), 'the others stand still'
    else:
        chosen = choices.decide(KEY, options, 'The log has several bodies that move.')
        why = choices.explain(KEY)
    choices.add_reason('body', by_name[chosen].place.columns, chosen, why)
    others = frozenset().union(*(one.words for one in bodies if one.name != chosen))
    others -= by_name[chosen].words
    return [group for group in groups if not _list_words(group) & others]


def _list_bodies(groups: Sequence[ColumnGroup], table: Columns) -> list[TrackedBody]:
    """Return the bodies whose positions a table has; estimates of one body count once."""
    bodies: list[TrackedBody] = []
    places = [group for group in groups if group.kind == 'position' and group.role != 'setpoint']
    shared = frozenset.intersection(*map(_list_words, places)) if places else frozenset[str]()
    for place in places:
        rows = place.stack(table)
        own = _list_words(place) - shared - COMMON
        own = frozenset(word for word in own if not match_role([word]))
        if not np.isfinite(rows).all(axis=1).any() or _is_held(rows):
            continue
        if any(_is_same(rows, one.place.stack(table)) for one in bodies):
            continue
        low, high = np.nanpercentile(rows, [2.0, 98.0], axis=0)
        name = '_'.join(word for word in parse_column_name(place.columns[0]).stem if word in own)
        bodies.append(TrackedBody(name, own, place, float((high - low).max())))
    return bodies if all(one.words for one in bodies) else bodies[:1]


def _list_words(group: ColumnGroup) -> frozenset[str]:
    return frozenset(word for name in group.columns for word in parse_column_name(name).stem)


def _is_held(rows: Numbers) -> bool:
    """Return whether a place is a setpoint: it moves, and is mostly held."""
    repeated = (np.diff(rows, axis=0) == 0.0).all(axis=1)
    return bool(HELD < repeated.mean() < 1.0)


def _is_same(rows: Numbers, others: Numbers) -> bool:
    """Return whether two places are those of one body: they move alike."""
    good = np.isfinite(rows).all(axis=1) & np.isfinite(others).all(axis=1)
    if not good.any():
        return False
    apart = (rows - others)[good]
    extent = float(np.ptp(rows[good], axis=0).max())
    spread = float(np.sqrt(((apart - apart.mean(axis=0)) ** 2).sum(axis=1).mean()))
    return spread < APART * extent
