# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run `lta import --draft`: propose a mapping, ask where two readings fit, and write it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
import sys
from typing import Any, cast

from lta_analysis.console import print_lines
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_data.importers.draft.choices import DraftQuestion, DraftVehicle
from lta_data.importers.draft.draft_mapping import draft_mapping, MappingDraft
from lta_data.importers.draft.draft_report import (
    build_draft_report,
    build_question_table,
    build_reason_table,
    group_channels,
    MAPPING,
)
from lta_data.plot.report import draw_curves
from lta_report.report_page import PAGE, write_report
from lta_report.report_terminal import print_report, print_table
from lta_report.request import Outcome
from lta_report.results_folder import (
    check_creatable,
    format_page_line,
    resolve_folder,
    stage_results,
)
from rich.console import Console


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
