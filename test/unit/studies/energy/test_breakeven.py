# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta energy breakeven: the map as JSON, and what is refused."""

import json

from lta_cli.app import run_command_line


def run(monkeypatch, *words):
    monkeypatch.setattr('sys.argv', ['lta', 'energy', 'breakeven', *words])
    return run_command_line()


def test_the_map_is_told(tmp_path, monkeypatch, capsys):
    assert run(monkeypatch, '--cell', 'dracula', '--json', '--out', str(tmp_path / 'o')) == 0
    told = json.loads(capsys.readouterr().out)
    own = told['break_even_lux']['2 x anysolar (as it is)']
    assert 5e3 < own['sun']['idle'] < 9e3
    assert own['white LED']['flying (paper)'] is None
    assert own['sun']['idle'] < own['sun']['transmitting'] < own['sun']['hovering (paper)']
    assert '29 x dracula' in told['break_even_lux']
    assert (tmp_path / 'o' / 'report.html').is_file()
