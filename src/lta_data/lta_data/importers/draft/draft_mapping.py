# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draft the mapping of a source, with reasons, questions and the first seconds."""

from collections.abc import Mapping, Sequence
from pathlib import Path
import re
from types import MappingProxyType
from typing import Any, final, NamedTuple

from lta_bag.bag_folder import find_bag
from lta_config.errors import BadInput, format_count
from lta_config.files import find_file
from lta_config.schema.import_file import TextFormat
from lta_data.flight import Channel
from lta_data.importers.draft.bag_topics import BagDraft, count_changing_commands, draft_bag_topics
from lta_data.importers.draft.bodies import select_body_rows
from lta_data.importers.draft.choices import DraftChoices, DraftVehicle
from lta_data.importers.draft.clock_alignment import align_clocks, AlignedClock
from lta_data.importers.draft.command_motion import check_wrenches, find_driven_axes, list_answers
from lta_data.importers.draft.table_draft import (
    draft_table,
    join_pose_tables,
    list_columns,
    TableDraft,
)
from lta_data.importers.formats import detect_format, LOG_FORMATS
from lta_data.importers.readers.column_log import Column
from lta_data.importers.readers.sensor_folder import (
    describe_empty_files,
    list_run_files,
    list_run_folders,
    read_folder,
    read_table_file,
    read_text_file,
)
from lta_data.importers.readers.text_dialect import detect_text_format, read_statements
import numpy as np
import yaml

COLUMN_FORMATS = (
    'csv',
    'mat',
    'numpy',
    'parquet',
    'folder',
)  # formats without meanings of their own
DRAFTED_RUNS = 10  # runs of a folder, the longest ones


@final
class SourceTables(NamedTuple):
    """A source."""

    path: Path  # the file that was read: of a folder with runs, the one that says most
    format: str
    tables: dict[str, dict[str, Column]]  # empty for a format whose names have fixed meanings
    text: TextFormat | None  # how the lines of a text are written
    notes: list[str]  # remarks, one sentence each
    stated: Mapping[str, str] = MappingProxyType({})  # by the file: the sequence of its angles


def read_source(source: Path) -> SourceTables:
    """Read a source; raise BadInput if it is of no known format."""
    path = find_bag(source)
    format_ = detect_format(path)
    empty = describe_empty_files(path)
    if format_ == 'folder':
        if folders := list_run_folders(path):
            note = f'The {len(folders)} folders of {source.name} are runs with the same tables.'
            return _read_richest_run(folders, note)
        files = list_run_files(path)
        kinds = {detect_format(file) for file in files}
        if len(files) == 1 or (len(kinds) == 1 and _have_same_columns(files)):
            runs = 'is one run' if len(files) == 1 else 'are runs with the same columns'
            note = f'The {format_count(len(files), "file")} of {source.name} {runs}.'
            return _read_richest_run(files, note, *empty)
        if not kinds <= {*COLUMN_FORMATS}:
            raise BadInput(
                f"Folder '{source}' has files of different formats ({', '.join(sorted(kinds))}), "
                'which cannot be one log; give a file of it.'
            )
    if format_ not in COLUMN_FORMATS:
        return SourceTables(path, format_, {}, None, [])
    if format_ == 'csv':
        tables, notes = read_text_file(path)
        text = detect_text_format(path)
        return SourceTables(path, format_, tables, text, notes, read_statements(path))
    tables, notes = read_folder(path) if format_ == 'folder' else read_table_file(path)
    return SourceTables(path, format_, tables, None, [*empty, *notes])


def _read_richest_run(runs: Sequence[Path], *notes: str) -> SourceTables:
    """Return the run in which most columns change: one without commands says little of them."""
    longest = sorted(runs, key=measure_size, reverse=True)[:DRAFTED_RUNS]
    richest = max((read_source(run) for run in longest), key=count_changing_columns)
    drafted = [f'Drafted from {richest.path.name}, in which most columns change.']
    more = drafted if richest.tables and len(runs) > 1 else []
    return richest._replace(notes=[*notes, *more, *richest.notes])


def count_changing_columns(source: SourceTables) -> int:
    """Return the number of columns with more than one value; of a bag, those of its commands."""
    if source.format == 'bag':
        return count_changing_commands(source.path)
    return sum(
        bool(len(column) and (column != column[0]).any())
        for table in source.tables.values()
        for column in table.values()
    )


def measure_size(path: Path) -> int:
    """Return the size of a log, which may be a folder of files [bytes]."""
    files = path.rglob('*') if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files if file.is_file())


def _have_same_columns(files: list[Path]) -> bool:
    """Return whether files are runs of one kind; the first two and the last decide."""
    if detect_format(files[0]) not in COLUMN_FORMATS:
        return True
    looked_at = {files[0], files[1], files[-1]}
    names = {
        tuple((name, *table) for name, table in read_table_file(file)[0].items())
        for file in looked_at
    }
    return len(names) == 1


FIRST_SECONDS = 10.0  # that the picture shows [s]


@final
class MappingDraft(NamedTuple):
    """A proposed mapping."""

    text: str  # the mapping file
    source: SourceTables
    choices: DraftChoices  # reasons and open questions
    # The first seconds of the columns in use, in the numbers of the log
    channels: list[Channel]
    unused: list[str]  # columns without a meaning
    silent: list[str]  # those of them that are empty or zero throughout


def draft_mapping(
    path: Path, answers: Mapping[str, str], vehicle: DraftVehicle | None = None
) -> MappingDraft:
    """
    Draft the mapping of a log or folder.

    `path`: the log. `answers`: decisions of the user by key, as the questions name them.
    `vehicle`: that flew, whose rotors commands are named after. Raise `BadInput` if the source
    cannot be read, nothing in it is recognised, or an answer is unknown.
    """
    source = read_source(path)
    choices = DraftChoices(answers, settled=dict(source.stated), vehicle=vehicle)
    if not source.tables:
        return _draft_shipped_format(source, choices)
    tables, joins = join_pose_tables(source.tables)
    whole = source = source._replace(tables=tables)
    source, wheres = _select_bodies(whole, choices)
    drafts, clocks = _draft_tables(source, choices)
    if driven := find_driven_axes(source.tables, drafts, clocks):
        # Once more, as what commands drive decides how columns are grouped
        follows = {column: one.text for column, one in driven.items()}
        choices = DraftChoices(
            answers, settled=dict(source.stated), vehicle=vehicle,
            by_motion=list_answers(driven), follows=follows,
        )  # fmt: skip
        source, wheres = _select_bodies(whole, choices)
        drafts, clocks = _draft_tables(source, choices)
    for name, clock in clocks.items():
        drafts[name].time.entry.update(clock.list_keys())
    for name, where in wheres.items():
        for entry in drafts[name].entries:
            entry['where'] = where
    for name, other in joins.items():
        for entry in drafts[name].entries:
            if any(column.startswith(f'{other}.') for column in list_columns(entry)):
                entry['join'] = [other]
    check_wrenches(source.tables, drafts, clocks, choices)
    content = _build_content(source, drafts, path, choices)
    choices.refuse_unused()
    left_out = {
        f'{name}.{column}' if name else column: source.tables[name][column]
        for name, draft in drafts.items()
        for column in draft.unused
    }
    silent = [one for one, cells in left_out.items() if _is_silent(cells)]
    text = _format_mapping(content, path)
    return MappingDraft(text, source, choices, _list_channels(source, drafts), [*left_out], silent)


def _select_bodies(
    source: SourceTables, choices: DraftChoices
) -> tuple[SourceTables, dict[str, dict[str, Any]]]:
    """Return a source with the rows of the vehicle alone, and what selects them by table."""
    tables, wheres = {}, {}
    for name, table in source.tables.items():
        tables[name], where = select_body_rows(table, choices)
        if where:
            wheres[name] = where
    return source._replace(tables=tables), wheres


def _draft_tables(
    source: SourceTables, choices: DraftChoices
) -> tuple[dict[str, TableDraft], dict[str, AlignedClock]]:
    """Return the drafts of the tables of a source, and the clocks that differ from the pose's."""
    drafts = {name: draft_table(name, table, choices) for name, table in source.tables.items()}
    return drafts, align_clocks(source.tables, drafts, choices)


def _is_silent(cells: Column) -> bool:
    """Return whether a column has no number but zero."""
    if cells.dtype.kind not in 'fiub':
        return all(str(cell).lower() in ('', 'nan') for cell in cells)
    return not np.nan_to_num(cells).any()


def _draft_shipped_format(source: SourceTables, choices: DraftChoices) -> MappingDraft:
    """Return the shipped mapping of a format with fixed names, or the topics of a bag by type."""
    shipped = LOG_FORMATS[source.format].mapping
    if shipped is not None:
        text = find_file('import mapping', shipped).read_text(encoding='utf-8')
        choices.add_reason(
            'all topics', [], f'mapping {shipped}', 'the firmware fixes names, units and axes'
        )
        choices.refuse_unused()
        return MappingDraft(text, source, choices, [], [], [])
    bag = draft_bag_topics(source.path, choices)
    choices.refuse_unused()
    content = _build_head(source, source.path) | {'topics': bag.entries}
    text = _format_mapping(content, source.path)
    return MappingDraft(text, source, choices, _list_bag_channels(bag), [], [])


def _build_head(source: SourceTables, path: Path) -> dict[str, Any]:
    name = re.sub(r'[^a-z0-9]+', '_', path.name.split('.')[0].lower()).strip('_')
    return {
        'schema': 1,
        'name': f'draft_{name or "log"}',
        'about': f'Drafted from {path.name}; see the reasons in its page.',
        'format': source.format,
        'data': 'measured',
    }


def _build_content(
    source: SourceTables, drafts: Mapping[str, TableDraft], path: Path, choices: DraftChoices
) -> dict[str, Any]:
    """Return the mapping as plain data."""
    content = _build_head(source, path)
    if source.text is not None:
        content['text'] = source.text.model_dump(exclude_defaults=True)
        if not content['text']:
            del content['text']
    used = {name: draft for name, draft in drafts.items() if draft.entries}
    if not used and (lost := [one for one in choices.reasons if one.reading == 'left out']):
        why = '; '.join(f'{one.columns} ({one.part}) is left out: {one.reason}' for one in lost)
        raise BadInput(f"Nothing of '{path}' becomes a topic: {why}.")
    if not used:
        names = ', '.join(list(dict.fromkeys(c for t in source.tables.values() for c in t))[:30])
        raise BadInput(
            f"No column of '{path}' is recognised ({names}); write a mapping as described in "
            'docs/import.md.'
        )
    times = [draft.time.entry for draft in used.values()]
    same = all(time == times[0] for time in times)
    joining = [draft.time.entry for draft in used.values()
               if any('join' in entry for entry in draft.entries)]  # fmt: skip
    # What is joined has no entry with a time of its own
    if same or joining:
        content['time'] = [*joining, *times][0]
    fillers: dict[str, dict[str, Any]] = {}  # the entry that fills a topic
    tables: dict[str, str] = {}
    for name, draft in used.items():
        for entry in draft.entries:
            topic = entry['topic']
            # A place is worth more than an attitude alone
            if topic not in fillers or ('position' in entry and 'position' not in fillers[topic]):
                fillers[topic], tables[topic] = entry, name
    # The table with the most parts of a motion decides on the axes
    axes = next((draft.axes for name, draft in sorted(
        used.items(), key=lambda one: -len(one[1].groups)
    ) if draft.axes and name in tables.values()), None)  # fmt: skip
    if axes is not None and axes.world != 'ENU':
        content['world'] = axes.world
    if axes is not None and axes.body != 'FLU':
        content['body'] = axes.body
    content['topics'] = []
    for name, draft in used.items():
        for entry in draft.entries:
            own = {} if same else {'time': draft.time.entry}
            body: dict[str, Any] = {}
            if 'body' in entry:
                pass  # as the motion shows
            elif draft.axes is not None and axes is not None and draft.axes.body != axes.body:
                body = {'body': draft.axes.body}
            elif entry['topic'] == 'wrench_command' and axes is not None and axes.body == 'Y_UP':
                # Only the tracker has y up
                body = {'body': 'FLU'}
            if entry is fillers[entry['topic']]:
                content['topics'].append(entry | own | body)
            elif name != tables[entry['topic']]:
                why = f"the table '{tables[entry['topic']]}' fills this topic"
                if 'orientation' in entry:
                    why += (
                        '; an attitude of another table joins it only if both have rows at the '
                        'same times, and no rates are beside it'
                    )
                choices.add_reason(entry['topic'], list_columns(entry), 'left out', why)
    return content


def _format_mapping(content: dict[str, Any], path: Path) -> str:
    """Return a mapping file; each part is on a line of its own."""
    head = {name: value for name, value in content.items() if name != 'topics'}
    lines = [f'# Drafted by lta import --draft from {path.name}; correct what is wrong.']
    for name, value in head.items():
        lines.append(f'{name}: {_format_value(value)}')
    lines.append('topics:')
    for entry in content['topics']:
        lines.append(f'  - topic: {entry["topic"]}')
        for name, value in entry.items():
            if name == 'topic':
                continue
            if name == 'actuators':
                lines.append('    actuators:')
                lines += [f'      {key}: {_format_value(one)}' for key, one in value.items()]
            else:
                lines.append(f'    {name}: {_format_value(value)}')
    return '\n'.join(lines) + '\n'


def _format_value(value: Any) -> str:
    """Return a value in one line of YAML."""
    text = yaml.safe_dump(value, default_flow_style=True, width=10_000, sort_keys=False,
                          allow_unicode=True)  # fmt: skip
    return text.removesuffix('...\n').strip()


def _list_bag_channels(bag: BagDraft) -> list[Channel]:
    """Return the first seconds of the poses, in the numbers of the bag."""
    channels = []
    for name, groups in bag.groups.items():
        table = bag.tables[name]
        seconds = (table.stamps - table.stamps[0]) * 1e-9
        early = seconds <= FIRST_SECONDS
        for group in groups:
            channels += [
                Channel(
                    f'{group.kind}.{column}',
                    group.kind,
                    seconds[early],
                    table.columns[column][early],
                )
                for column in group.columns
            ]
    return channels


def _list_channels(source: SourceTables, drafts: Mapping[str, TableDraft]) -> list[Channel]:
    """Return the first seconds of all groups, in the numbers of the log."""
    channels = []
    for name, draft in drafts.items():
        early = draft.time.seconds <= FIRST_SECONDS
        for group in draft.groups:
            for column in group.columns:
                values = np.asarray(source.tables[name][column], dtype=np.float64)[early]
                label = f'{name}/{group.kind}.{column}' if name else f'{group.kind}.{column}'
                channels.append(Channel(label, group.kind, draft.time.seconds[early], values))
    return channels
