# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Report a draft: reasons, open questions, columns without a meaning, and the first seconds."""

from pathlib import Path
from typing import Final

from lta_data.flight import Channel
from lta_data.importers.draft.choices import DraftQuestion
from lta_data.importers.draft.draft_mapping import FIRST_SECONDS, MappingDraft
from lta_data.plot.report import plot_channels
from lta_report.formatting import format_count, Tile
from lta_report.report import Grid, Picture, Report, TextSection, TextTable
import yaml

MAPPING: Final = 'mapping.yaml'


def build_draft_report(source: Path, draft: MappingDraft, commands: dict[str, str]) -> Report:
    """Return the report of a draft without open questions."""
    topics = sum(line.startswith('  - topic:') for line in draft.text.splitlines())
    notes = [*draft.source.notes]
    unknown = [column for column in draft.unused if column not in draft.silent]
    if draft.silent:
        notes.append(f'Columns without a number but zero: {", ".join(draft.silent)}.')
    if unknown:
        notes.append(
            f'Columns without a meaning: {", ".join(unknown)}. If one commands an actuator, '
            f'add --set {unknown[0]}.topic=motors; if one commands a force or moment of the body, '
            f'--set {unknown[0]}.command=surge (sway, heave, roll, pitch, yaw).'
        )
    if missing := list_missing_parts(draft.text):
        notes.append(
            f'The mapping has no {" and no ".join(missing)}; lta calibrate and lta discover need '
            'position, attitude and commands.'
        )
    sections = [TextSection('Remarks', notes, printed=True)] if notes else []
    return Report(
        command='import --draft',
        subject=source.name,
        headline=f'{format_count(topics, "topic")} of {source.name} recognised.',
        introduction=(
            'A mapping proposed from the names and the physics of the columns. Check the reasons, '
            'and correct the mapping where they are wrong.'
        ),
        tiles=[
            Tile('topics', str(topics), '', draft.source.format),
            Tile('columns left out', str(len(draft.unused)), '', ''),
        ],
        blocks=[
            build_reason_table(draft),
            *sections,
            Grid(plot_first_seconds(draft.channels), columns=1, name='first_seconds'),
        ],
        data={
            'mapping': draft.text,
            'reasons': [reason._asdict() for reason in draft.choices.reasons],
            'unused': draft.unused,
            'notes': notes,
        },
        facts={'source': source.name, 'format': draft.source.format},
        commands=commands,
        files={MAPPING: draft.text},
        json_name='draft.json',
        outputs={MAPPING: draft.text},
    )


def list_missing_parts(mapping: str) -> list[str]:
    """Return what calibration and discovery need and a mapping lacks."""
    topics = yaml.safe_load(mapping)['topics']
    states = [each for each in topics if each['topic'] in ('ground_truth/odom', 'odom')]
    # A topic of a bag has the parts of its type
    whole = [
        each for each in states if 'table' in each and not {'position', 'orientation'} & {*each}
    ]
    there = {
        'position': bool(whole) or any('position' in each for each in states),
        'attitude': bool(whole) or any('orientation' in each for each in states),
        'commands': any(each['topic'] in ('motors', 'wrench_command') for each in topics),
    }
    return [name for name, is_there in there.items() if not is_there]


def build_reason_table(draft: MappingDraft) -> TextTable:
    """Return the table of reasons."""
    return TextTable(
        'What the columns are', ['part', 'columns', 'reading', 'because'],
        [list(reason) for reason in draft.choices.reasons],
    )  # fmt: skip


def build_question_table(question: DraftQuestion) -> TextTable:
    """Return the interpretations of a question, with the option that decides for each."""
    rows = [[f'--set {question.key}={name}', meaning] for name, meaning in question.options]
    return TextTable('', ['option', 'meaning'], rows)


def group_channels(channels: list[Channel]) -> dict[str, list[Channel]]:
    """Return channels by their group, such as 'imu/rates'."""
    panels: dict[str, list[Channel]] = {}
    for channel in channels:
        panels.setdefault(channel.name.split('.')[0], []).append(channel)
    return panels


def plot_first_seconds(channels: list[Channel]) -> list[Picture]:
    """Return a figure of each group of columns."""
    return [
        Picture(
            f'first-{index}', name, 'As logged.',
            plot_channels('', lines, (0.0, min(FIRST_SECONDS, float(lines[0].time[-1])))),
            height=220, timed=True,
        )
        for index, (name, lines) in enumerate(group_channels(channels).items())
        if len(lines[0].time)
    ]  # fmt: skip
