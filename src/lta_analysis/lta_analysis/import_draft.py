# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run `lta import --draft`: propose a mapping, ask where two readings fit, and write it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
import sys
from typing import Any, cast, Final

from lta_analysis.console import print_lines
from lta_analysis.plot import draw_curves, plot_channels
from lta_config.atomic_file import stage_results
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput, format_count
from lta_data.flight import Channel
from lta_data.importers.draft.choices import DraftQuestion, DraftVehicle
from lta_data.importers.draft.draft_mapping import draft_mapping, FIRST_SECONDS, MappingDraft
from lta_report.formatting import Tile
from lta_report.report import Grid, Picture, Report, TextSection, TextTable
from lta_report.report_page import PAGE, write_report
from lta_report.report_terminal import print_report, print_table
from lta_report.request import Outcome
from lta_report.results_folder import check_creatable, format_page_line, resolve_folder
from rich.console import Console
import yaml

MAPPING: Final = 'mapping.yaml'


def run_draft(
    sources: Sequence[Path],
    settings: Mapping[str, str],
    vehicle: str | None,
    out: Path | None,
    console: Console,
) -> Outcome[Path | None]:
    """
    Draft the mapping of one log or folder, and write it with its page; return its path.

    `vehicle`: name or file of the one that flew, after whose rotors commands are named.

    Raise `BadInput` if several sources are named, or nothing is recognised.
    """
    if len(sources) != 1:
        raise BadInput('--draft needs one log or one folder; draft one, and import all with it.')
    source = sources[0]
    folder = resolve_folder(out, f'{source.name.split(".")[0] or "log"}-draft')
    check_creatable(folder)
    answers = dict(settings)
    draft_vehicle = None if vehicle is None else DraftVehicle.load(vehicle)
    draft = draft_mapping(source, answers, draft_vehicle)
    while draft.choices.questions:
        if not (console.is_terminal and sys.stdin.isatty()):
            print_questions(draft, console)
            return Outcome(None, status=2)
        print_table(build_reason_table(draft), console)
        question = draft.choices.questions[0]
        answers[question.key] = ask_user(question, console)
        try:
            draft = draft_mapping(source, answers, draft_vehicle)
        except BadInput as fault:
            # The answer to an open question may not fit
            print_lines(console, str(fault), style='yellow')
            del answers[question.key]
    named = [] if vehicle is None else ['--vehicle', vehicle]
    mapping = folder / MAPPING
    command = format_lta_command(
        'import', relative_path(source), '--mapping', relative_path(mapping), *named
    )
    report = build_draft_report(source, draft, {'Import with it': command})
    with stage_results(folder, PAGE) as staged:
        write_report(report, staged, page=True, pictures=None)
    print_report(report, console)
    if console.is_terminal:
        print_first_seconds(draft, console)
    print_lines(
        console,
        f'Mapping {relative_path(mapping)}',
        format_page_line(relative_path(folder / PAGE)),
        f'Import with it: {command}',
    )
    return Outcome(mapping, {**cast('Mapping[str, Any]', report.data), 'page': str(folder / PAGE)})


def print_questions(draft: MappingDraft, console: Console) -> None:
    """Print the reasons, and for each question both readings with the option that decides."""
    print_table(build_reason_table(draft), console)
    for question in draft.choices.questions:
        print_lines(console, question.reason, style='bold')
        print_table(build_question_table(question), console)
    count = len(draft.choices.questions)
    words = 'One reading is' if count == 1 else f'{count} readings are'
    print_lines(
        console,
        f'{words} not decided; repeat the command with the --set that is right. Nothing is '
        'written.',
    )


def ask_user(question: DraftQuestion, console: Console) -> str:
    """
    Ask which reading is right, on the terminal, until the answer is one that fits.

    Raise `BadInput` if the input ends.
    """
    names = [name for name, _ in question.options]
    print_lines(console, question.reason, style='bold')
    print_lines(console, *(f'  {name}: {meaning}' for name, meaning in question.options))
    examples = 'such as ' if question.is_open else ''
    while True:
        console.print(
            f'{question.key} ({examples}{", ".join(names)}): ', end='', highlight=False,
            markup=False,
        )  # fmt: skip
        try:
            answer = input().strip()
        except EOFError:
            choices = ' or '.join(f'--set {question.key}={name}' for name in names)
            raise BadInput(
                f'The input ended before {question.key} was decided; repeat the command with '
                f'{choices}.'
            ) from None
        if answer in names or (question.is_open and answer):
            return answer
        print_lines(console, f"  '{answer}' is none of them.")


def print_first_seconds(draft: MappingDraft, console: Console) -> None:
    """Draw the first seconds on the terminal, one panel for each group of columns."""
    for name, channels in group_channels(draft.channels).items():
        if len(channels[0].time) > 1:
            span = (float(channels[0].time[0]), float(channels[0].time[-1]))
            console.print(draw_curves(name, channels, span, console.width), soft_wrap=True)


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
