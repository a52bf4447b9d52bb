# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What commands, launch files and pages write without being told where is in runs/, out of git."""

from pathlib import Path
import re

from lta_cli.app import build_app
from lta_graph.launches import EMULATED, FLEET, FLY
import pytest
from typer.main import get_command

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / 'README.md', *sorted((ROOT / 'docs').glob('**/*.md'))]
PAGES.remove(ROOT / 'docs/discovery_flights.md')  # works in the folder of the published flights
# A folder of results in a command of a page: --out FOLDER, bag:=FOLDER
WRITTEN = re.compile(r'^[^#\n]*?(?:--out |\bbag:=)"?([\w./-]+)', re.MULTILINE)
COMMAND = re.compile(r'^(?:Example: `|\./lta ).*', re.MULTILINE)
# Elsewhere on purpose: a place for others to fill in, and folders outside of the repository
ELSEWHERE = re.compile(r'runs/|/|\.\.\.|[A-Z]+$')


def list_options(command, path=()):
    """Yield each option of each command that has a default."""
    if hasattr(command, 'commands'):
        for name, inner in command.commands.items():
            yield from list_options(inner, (*path, name))
        return
    for option in command.params:
        if isinstance(option.default, Path):
            yield ' '.join((*path, option.name)), option.default


def test_what_commands_write_by_default_is_in_runs():
    found = dict(list_options(get_command(build_app())))
    assert [name for name, path in found.items() if path.parts[0] != 'runs'] == []


@pytest.mark.parametrize('launch', [FLY, FLEET, EMULATED], ids=['fly', 'fleet', 'emulated'])
def test_launches_record_into_runs(launch):
    assert launch.arguments().bag == 'runs/bag'


def test_pages_write_into_runs():
    written = [
        (page.name, folder)
        for page in PAGES
        for command in COMMAND.findall(page.read_text(encoding='utf-8'))
        for folder in WRITTEN.findall(command)
    ]
    assert len(written) > 20
    assert [each for each in written if not ELSEWHERE.match(each[1])] == []
