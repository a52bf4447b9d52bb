# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check bags and report the findings on the terminal and as JSON."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from textwrap import fill
from typing import Any, Final, final

from lta_bag.bag_folder import find_bag
from lta_bag.reader import read_bag
from lta_data.bag.channels import read_flight
from lta_data.bag.recorded_flight import list_robots, open_flight
from lta_data.data_quality.duplicate_runs import find_duplicate_runs
from lta_data.data_quality.recording import QualityFinding, Severity
from lta_data.data_quality.registry import QualityReport, run_checks
from lta_data.flight import Flight
from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn
from rich.text import Text

SEVERITY_STYLES: Final = {
    Severity.NOTE: 'dim',
    Severity.WARNING: 'yellow',
    Severity.SUSPICIOUS: 'red',
    Severity.ERROR: 'bold red',
}

REPORT_WIDTH: Final = 120  # characters of a line, also in a pipe
INDENT: Final = '    '  # before the evidence


@final
@dataclass(frozen=True, slots=True)
class CheckedRecording:
    """The checked data of one robot in one bag."""

    # The bag and its robot; '' without one
    path: str
    robot: str
    simulated: bool  # whether the recording declares itself simulated
    report: QualityReport  # the findings
    losses: tuple[str, ...]  # what is missing or unreadable, one sentence each

    @property
    def is_grave(self) -> bool:
        """Whether any finding is suspicious or an error, or nothing could be judged."""
        return self.report.is_grave or self.report.status == 'not checked'


def check_bags(
    paths: Sequence[Path], robot: str | None, console: Console
) -> list[CheckedRecording]:
    """
    Check bags separately, then against each other.

    Raise `BadInput` if one of them is not a bag, or lacks the robot.
    """
    done: list[CheckedRecording] = []
    seen: list[tuple[str, Flight]] = []
    columns = (TextColumn('{task.description}'), BarColumn())
    with ProgressBar(console, *columns, begin='checking', total=len(paths)) as bar:
        for path in paths:
            bar.update_bar(description=f'checking {path}')
            for one, recording in _check_bag(path, robot):
                done.append(one)
                seen.append((f'{one.path} {one.robot}'.strip(), recording))
            bar.update_bar(advance=1)
    again = find_duplicate_runs(seen) if len(paths) > 1 else {}
    return [
        one if name not in again else _add_findings(one, again[name])
        for one, (name, _) in zip(done, seen, strict=True)
    ]


def _check_bag(path: Path, robot: str | None) -> list[tuple[CheckedRecording, Flight]]:
    """Check the data of each robot in a bag."""
    bag = read_bag(find_bag(path))
    # None: a bag whose topics have no namespace
    robots: list[str | None] = [robot] if robot is not None else [*list_robots(bag)] or [None]
    reports = []
    for name in robots:
        flight = open_flight(bag, name)
        recording = read_flight(flight, raw=True)
        report = run_checks(recording)
        one = CheckedRecording(
            str(path), recording.robot, recording.is_simulated, report, recording.losses
        )
        reports.append((one, recording))
    return reports


def _add_findings(one: CheckedRecording, more: list[QualityFinding]) -> CheckedRecording:
    """Return a checked recording with additional findings."""
    report = replace(one.report, findings=(*one.report.findings, *more))
    return replace(one, report=report)


def encode_findings(done: Sequence[CheckedRecording]) -> list[dict[str, Any]]:
    """Return the results as a JSON list with one entry per robot and bag."""
    return [
        {
            'path': one.path,
            'robot': one.robot,
            'simulated': one.simulated,
            'status': one.report.status,
            'clean': one.report.status == 'clean',
            'suspicious': one.report.is_grave,
            'findings': [asdict(finding) for finding in one.report.findings],
            'judged': list(one.report.judged),
            'unjudged': list(one.report.unjudged),
            'losses': list(one.losses),
        }
        for one in done
    ]


def print_findings(one: CheckedRecording, console: Console) -> None:
    """Print the findings of one recording."""
    width = min(REPORT_WIDTH, console.width)
    whose = f' ({one.robot})' if one.robot else ''
    kind = ', declared as simulated' if one.simulated else ''
    console.print(f'{one.path}{whose}{kind}', style='bold', highlight=False, markup=False)
    for finding in one.report.findings:
        head = Text(finding.severity.value, SEVERITY_STYLES[finding.severity])
        head.append(f'  {finding.kind}  ').append(finding.channel, 'bold')
        head.append(f'  {finding.from_s:.2f} to {finding.to_s:.2f} s')
        console.print(head, soft_wrap=True)
        # By `textwrap`, as rich fills lines with spaces
        evidence = fill(finding.evidence, width, initial_indent=INDENT, subsequent_indent=INDENT)
        console.print(Text(evidence), soft_wrap=True)
    if one.report.status == 'clean':
        console.print('clean', style='green')
    elif one.report.status == 'not checked':
        console.print('not checked: nothing in it can be judged', style='red', highlight=False)
    if one.report.judged:
        text = f'Judged: {"; ".join(one.report.judged)}.'
        console.print(Text(text, 'dim'), width=width)
    for sentence in one.report.unjudged:
        console.print(Text(sentence, 'dim'), width=width)
    for loss in one.losses:
        console.print(Text(loss, 'yellow'), width=width)
