# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The example of a design loop runs, and its figures are those of closed forms."""

import math
from pathlib import Path
import runpy
import sys

import pytest

EXAMPLE = Path(__file__).resolve().parents[3] / 'examples/hull_shapes.py'


def test_the_design_loop_finds_what_carries_most_for_its_drag(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, 'argv', [str(EXAMPLE)])
    runpy.run_path(str(EXAMPLE), run_name='__main__')
    _, *rows, _ = capsys.readouterr().out.splitlines()
    found = {(row.split()[0], float(row.split()[1])): row.split()[2:] for row in rows}
    assert len(found) == 18
    carried, braked, *_ = found['sphere', 1.0]
    # 0.93 (1.2041 - 0.1664) pi / 6 m3, less 0.047 kg/m2 on pi m2.
    assert float(carried) == pytest.approx(505.3 - 147.7, abs=2.0)
    friction = 1.328 / math.sqrt(0.5 / 1.5e-5)
    assert float(braked) == pytest.approx(
        1e3 * 0.6 * 0.25 * math.pi / 4 * (0.44 + 8.0 * friction), rel=0.01
    )
    assert [name for name, row in found.items() if '*' in row] == [
        ('sphere', 1.1), *((('cigar', size)) for size in (0.6, 0.7, 0.8, 0.9, 1.0, 1.1))
    ]  # fmt: skip
    assert (tmp_path / 'hull_shapes.html').is_file()
