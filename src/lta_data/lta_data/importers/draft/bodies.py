# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tell the bodies of a tracker apart, in columns, rows or topics, and choose the vehicle."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, final, NamedTuple

from lta_config.schema.import_file import ImportMapping
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import group_columns
from lta_data.importers.draft.motion_kinds import find_places
from lta_data.importers.entry_plan import MESSAGE_SHAPES
from lta_data.importers.formats import LOG_FORMATS
from lta_data.importers.protocol import LogReader, LogTable, Numbers
from lta_data.importers.readers.bag_tables import BagTableLog, BODY_TYPES, FURTHER
from lta_data.importers.readers.column_log import Column
from lta_data.interpretation.column_group import ColumnGroup, Columns
from lta_data.interpretation.column_names import KIND_WORDS, match_role, parse_column_name
from lta_data.interpretation.commands import is_held
import numpy as np

BODY_SPREAD: Final = 0.2  # of their extent; two estimates of one body are closer
STILL_SHARE: Final = 0.02  # of the largest extent; a body that moves less stands still
MOST_BODIES: Final = 20
FEWEST_ROWS: Final = 20  # of a body
ALTERNATING: Final = 0.2  # share of the rows that are of another body than the row before
RISES: Final = 0.9  # share of the steps of a time
FARTHER: Final = 4.0  # times as far from row to row as within a body
BODY_KEY: Final = 'body'
# Not the name of a body
NO_BODY_WORDS: Final = frozenset([
    *(word for words in KIND_WORDS.values() for word in words), 'rigid', 'body', 'marker',
    'markers', 'global', 'world', 'state', 'field', 'header', 'msg', 'data',
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
    extents = {body.name: body.extent for body in bodies}
    columns = {body.name: f'{", ".join(body.place.columns)}: ' for body in bodies}
    question = 'The log has several bodies that move.'
    chosen, why = _choose_moving(extents, BODY_KEY, question, choices, columns)
    choices.add_reason('body', by_name[chosen].place.columns, chosen, why)
    others = frozenset().union(*(one.words for one in bodies if one.name != chosen))
    others -= by_name[chosen].words
    return [group for group in groups if not group.stem_words & others]


def select_body_rows(
    table: Mapping[str, Column], choices: DraftChoices
) -> tuple[dict[str, Column], dict[str, Any]]:
    """
    Return the rows of the vehicle where those of several bodies follow each other, and `where`.

    A column of names or numbers tells them apart, if the places of each change far less from row
    to row than those of all.
    """
    for label in table:
        labels, counts = np.unique(table[label], return_counts=True)
        if not 2 <= len(labels) <= MOST_BODIES or counts.min() < FEWEST_ROWS:
            continue
        groups, _ = group_columns({
            name: cells for name, cells in table.items()
            if cells.dtype.kind in 'fiub' and name != label
        })  # fmt: skip
        place = next((one for one in find_places(groups) if one.kind == 'position'), None)
        is_stacked = _restarts(table, label, labels)
        if place is None or not (
            is_stacked or _tells_apart(place.stack(table), table[label], labels)
        ):
            continue
        where = _choose_label(label, labels, place.stack(table), table[label], choices)
        rows = table[label] == where
        others = {name: cells[rows] for name, cells in table.items() if name != label}
        return others, {label: where.item()}
    return dict(table), {}


def _restarts(table: Mapping[str, Column], label: str, labels: Column) -> bool:
    """Return whether all rows of a body follow those of another: the time begins anew."""
    changes = np.flatnonzero(table[label][1:] != table[label][:-1])
    if len(changes) != len(labels) - 1:
        return False
    steps = (np.diff(one) for one in table.values() if one.dtype.kind in 'fiu')
    return any((one[changes] < 0.0).all() and (one > 0.0).mean() > RISES for one in steps)


def _tells_apart(rows: Numbers, cells: Column, labels: Column) -> bool:
    """Return whether places change far less within the rows of one label than from row to row."""
    alternates = np.mean(cells[1:] != cells[:-1]) > ALTERNATING
    if not alternates or not np.isfinite(rows).any():
        return False
    within = max(_measure_step(rows[cells == label]) for label in labels)
    return bool(_measure_step(rows) > FARTHER * within)


def _measure_step(rows: Numbers) -> float:
    return float(np.nanpercentile(np.linalg.norm(np.diff(rows, axis=0), axis=1), 75.0))


def _choose_moving(
    extents: Mapping[str, float],
    key: str,
    question: str,
    choices: DraftChoices,
    about: Mapping[str, str] = MappingProxyType({}),
) -> tuple[str, str]:
    """Return the only body that moves, or of several the one that the user says; and why."""
    names = sorted(extents, key=lambda name: -extents[name])
    moving = [name for name in names if extents[name] > STILL_SHARE * extents[names[0]]]
    if len(moving) < 2 and key not in choices.answers:
        return choices.override(key, names[0]), 'the others stand still'
    options = [(name, f'{about.get(name, "")}moves over {extents[name]:.3g}') for name in names]
    return choices.decide(key, options, question), choices.explain(key)


def _choose_label(
    column: str, labels: Column, rows: Numbers, cells: Column, choices: DraftChoices
) -> Any:
    """Return the label of the vehicle: of the only body that moves, or as the user says."""
    extents = {}
    for label in labels:
        low, high = np.nanpercentile(rows[cells == label], [2.0, 98.0], axis=0)
        extents[str(label)] = float((high - low).max())
    question = f'The rows of several bodies follow each other, by {column}.'
    chosen, why = _choose_moving(extents, BODY_KEY, question, choices)
    choices.add_reason('body', [column], chosen, why)
    return next(label for label in labels if str(label) == chosen)


def _list_bodies(groups: Sequence[ColumnGroup], table: Columns) -> list[TrackedBody]:
    """Return the bodies whose positions a table has; estimates of one body count once."""
    bodies: list[TrackedBody] = []
    places = [group for group in groups if group.kind == 'position' and group.role != 'setpoint']
    shared = (
        frozenset.intersection(*(one.stem_words for one in places)) if places else frozenset[str]()
    )
    for place in places:
        rows = place.stack(table)
        own = place.stem_words - shared - NO_BODY_WORDS
        own = frozenset(word for word in own if not match_role([word]))
        if not np.isfinite(rows).all(axis=1).any() or is_held(rows):
            continue
        if any(_is_same(rows, one.place.stack(table)) for one in bodies):
            continue
        low, high = np.nanpercentile(rows, [2.0, 98.0], axis=0)
        words = dict.fromkeys(parse_column_name(place.columns[0]).stem)
        name = '_'.join(word for word in words if word in own)
        bodies.append(TrackedBody(name, own, place, float((high - low).max())))
    return bodies if all(one.words for one in bodies) else bodies[:1]


def _is_same(rows: Numbers, others: Numbers) -> bool:
    """Return whether two places are those of one body: they move alike."""
    good = np.isfinite(rows).all(axis=1) & np.isfinite(others).all(axis=1)
    if not good.any():
        return False
    apart = (rows - others)[good]
    extent = float(np.ptp(rows[good], axis=0).max())
    spread = float(np.sqrt(((apart - apart.mean(axis=0)) ** 2).sum(axis=1).mean()))
    return spread < BODY_SPREAD * extent


def choose_bag_body(
    path: Path, log: LogReader, types: Mapping[str, str], key: str, choices: DraftChoices
) -> dict[str, str]:
    """Return the table of the vehicle in a topic of several bodies, such as /tf, and its type."""
    assert isinstance(log, BagTableLog)
    tables = {
        name: kind
        for topic, kind in types.items()
        if kind in BODY_TYPES and not topic.endswith('_static')
        for name in log.list_bodies(topic)
    }
    if not tables:
        return {}
    chosen = choose_moving(path, tables, key, 'The bag has the poses of several bodies.', choices)
    return {chosen: tables[chosen]}


def choose_moving(
    path: Path, tables: Mapping[str, str], key: str, question: str, choices: DraftChoices
) -> str:
    """
    Return the table of poses of the only body that moves; of several, the user chooses.

    `tables`: message types by table.
    """
    extents = {}
    for name, table in read_tables(path, [*tables]).items():
        shape = FURTHER.get(tables[name]) or MESSAGE_SHAPES[tables[name]]
        rows = np.stack([table.columns[f'{shape["position"].place}.{a}'] for a in 'xyz'], axis=1)
        low, high = np.nanpercentile(rows, [2.0, 98.0], axis=0)
        extents[name] = float(np.max(high - low))
    chosen, _ = _choose_moving(extents, key, question, choices)
    listed = ', '.join(
        f'{name} (moves over {extents[name]:.3g})'
        for name in sorted(extents, key=lambda name: -extents[name])
    )
    choices.add_reason('body', [chosen], chosen, f'of {listed}')
    return chosen


def read_tables(path: Path, names: Sequence[str]) -> Mapping[str, LogTable]:
    """Return topics as tables, with a column for each number; those without a message lack."""
    if not names:
        return {}
    number = {'effort': {'column': '-'}}
    topics = [{'topic': 'motors', 'table': one, 'actuators': {'any': number}} for one in names]
    head = {'schema': 1, 'name': 'draft', 'about': 'A draft.', 'format': 'bag', 'data': 'measured'}
    log = LOG_FORMATS['bag'].opened(path, ImportMapping.model_validate({**head, 'topics': topics}))
    there = {name: set[str]() for name in names if name in log.columns}
    return log.read_tables(there)
