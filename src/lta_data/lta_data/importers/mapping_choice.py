# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Choose the mapping of a log, and the entries that the log can fill."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import final, NamedTuple

from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
from lta_config.schema.import_file import ImportMapping, load_mapping, TopicMapping
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_data.importers.entry_plan import EntryPlan, plan_entry
from lta_data.importers.formats import LOG_FORMATS
from lta_data.importers.protocol import LogReader
from lta_data.importers.readers.bag_tables import can_pass_unchanged, complete_entry
from lta_data.importers.readers.csv_text import missing_columns_error, read_header

MASS_ACTUATOR = 'moving_mass'  # its position is logged as actuators moving_mass_x, _y and _z


@final
class MappingChoice(NamedTuple):
    """What to do with a log."""

    plans: list[EntryPlan]  # the entries that its columns can fill
    renamed: dict[str, str]  # topics of a bag that are passed on unchanged -> their new names
    absent: list[str]  # topics of the mapping that this log cannot fill


def select_mapping(
    path: Path, format_: str, requested: str | None
) -> tuple[ImportMapping | None, str]:
    """
    Return the mapping of a log and its text; None if a bag needs no mapping.

    Raise `BadInput` if the mapping is for another format, or none is named and none fits.
    """
    name = requested or LOG_FORMATS[format_].mapping
    if name is None and format_ == 'csv':
        name = _detect_mapping(path)
    if name is None and format_ != 'bag':
        raise BadInput(
            f"'{path}' needs a mapping, since no shipped one is for the format {format_}; propose "
            f'one with --draft, and give it with --mapping.'
        )
    if name is None:
        return None, ''
    mapping, text = load_mapping(name)
    if mapping.format != format_:
        raise BadInput(
            f"Mapping '{name}' is for the format {mapping.format}, but '{path}' has the format "
            f'{format_}; choose another mapping with --mapping.'
        )
    return mapping, text


def _detect_mapping(path: Path) -> str:
    """Return the only shipped mapping whose columns are all in the text."""
    there = set(read_header(path))
    fitting = []
    for name in list_shipped_names('imports'):
        mapping, _ = load_mapping(name)
        # A mapping that gives the header itself would fit any file
        if mapping.format == 'csv' and mapping.text.header is None:
            needed = {column for entry in mapping.topics for column in entry.columns}
            if needed <= there:
                fitting.append(name)
    # Two fitting mappings may disagree on units, so the user must choose.
    if len(fitting) == 1:
        return fitting[0]
    if fitting:
        raise BadInput(
            f"Several mappings fit '{path}': {', '.join(fitting)}; choose one with --mapping."
        )
    raise BadInput(
        f"No shipped mapping fits the columns of '{path}'; propose one with --draft, or write one "
        'as described in docs/import.md, and give it with --mapping.'
    )


def choose_entries(
    path: Path, mapping: ImportMapping | None, log: LogReader, robot: str
) -> MappingChoice:
    """
    Return the entries of a mapping that a log fills; of several for one topic, the first.

    Raise `BadInput` if a required column is missing, or no entry can be filled.
    """
    choice = MappingChoice([], {}, [])
    filled: set[str] = set()
    for entry in [] if mapping is None else mapping.topics:
        assert mapping is not None
        # Entries for one topic are alternatives, in order of preference.
        if entry.topic in filled:
            continue
        plan = _plan_entry(path, mapping, log, entry, robot)
        if plan is None:
            choice.absent.append(entry.topic)
            continue
        filled.add(entry.topic)
        if plan.entry.table is not None and _is_renamed(plan, mapping, log):
            choice.renamed[plan.entry.table] = plan.topic
        else:
            choice.plans.append(plan)
    absent = [topic for topic in dict.fromkeys(choice.absent) if topic not in filled]
    if mapping is not None and not filled:
        there = ', '.join(list(dict.fromkeys(_list_contents(log)))[:30])
        raise BadInput(
            f"'{path}' has no data that the mapping '{mapping.name}' uses; it has {there}. Choose "
            'another mapping with --mapping.'
        )
    return choice._replace(absent=absent)


def describe_unknown_actuators(vehicle: str, chosen: MappingChoice) -> list[str]:
    """
    Return a remark if the log has actuators that the vehicle lacks.

    Raise `BadInput` if the vehicle is unknown or its file is invalid.
    """
    file = load_vehicle_file(vehicle)
    there = {*file.rotors, *(f'{MASS_ACTUATOR}_{axis}' for axis in 'xyz' if file.moving_mass)}
    names = [name for plan in chosen.plans for name in plan.entry.actuators or {}]
    strange = [name for name in names if name not in there]
    if not strange:
        return []
    return [
        f"Vehicle '{vehicle}' lacks these actuators of the log: {', '.join(strange)}; it has "
        f'{", ".join(sorted(there))}.'
    ]


def _plan_entry(
    path: Path, mapping: ImportMapping, log: LogReader, entry: TopicMapping, robot: str
) -> EntryPlan | None:
    """Return the plan of an entry; None if it is optional and cannot be filled."""
    # First check the entry alone, so that errors of the mapping do not depend on the log
    plan = plan_entry(entry, mapping, robot)
    table = entry.table or ''
    if not table and '' not in log.columns:
        table = _find_only_table(log, entry)
    absent = [name for name in [table, *entry.join] if name not in log.columns]
    if absent:
        if entry.optional:
            return None
        known_tables = ', '.join(sorted(log.raw or log.columns)) or 'none'
        raise BadInput(
            f"'{path}' lacks the table '{absent[0]}', which the mapping needs; it has "
            f'{known_tables}. Correct the mapping, or choose another one with --mapping.'
        )
    # '#' selects a child frame of a transform topic
    if table in log.raw or '#' in table:
        raw = log.raw[table.split('#')[0]]
        if not can_pass_unchanged(entry, mapping, raw.definition.type_name, plan.target.type_name):
            entry = complete_entry(entry, raw.definition.type_name, plan.target.type_name)
    there = list_columns(log, table, entry.join)
    if mapping.format == 'dataflash':
        # Before ArduPilot 4.1, a table has no number of its core or sensor: it is the first
        where = {name: value for name, value in entry.where.items() if name in there}
        entry = entry.model_copy(update={'where': where})
    lacking = [name for name in entry.columns if name not in there]
    if lacking and entry.optional:
        return None
    if lacking:
        raise missing_columns_error(path, lacking, [name for name in log.columns[table] if name])
    if table:
        entry = entry.model_copy(update={'table': table})
    # Again, since the entry was completed from the log
    return plan_entry(entry, mapping, robot)


def _find_only_table(log: LogReader, entry: TopicMapping) -> str:
    """Return the table of an entry that names none: the one with its columns."""
    fitting = [name for name, columns in log.columns.items() if {*entry.columns} <= {*columns}]
    return fitting[0] if fitting else next(iter(log.columns))


def list_columns(log: LogReader, table: str, join: Collection[str]) -> set[str]:
    """Return the columns of a table and of the tables joined to it."""
    there = set(log.columns[table])
    for name in join:
        there |= {f'{name}.{column}' for column in log.columns[name]}
    return there


def _is_renamed(candidate: EntryPlan, mapping: ImportMapping, log: LogReader) -> bool:
    """Return whether a topic of a bag is passed on unchanged."""
    raw = log.raw.get(candidate.entry.table or '')
    return raw is not None and can_pass_unchanged(
        candidate.entry, mapping, raw.definition.type_name, candidate.target.type_name
    )


def _list_contents(log: LogReader) -> Sequence[str]:
    """Return the contents of a log, by table and column."""
    return list(log.raw) or [
        f'{table}: {column}' if table else column
        for table, columns in log.columns.items()
        for column in columns
    ]
