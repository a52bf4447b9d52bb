# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Every example runs; those that take a flight or a tunnel are tested beside these."""

from pathlib import Path
import runpy

ROOT = Path(__file__).resolve().parents[3]


def test_vehicles_side_by_side(capsys):
    runpy.run_path(str(ROOT / 'examples/compare_vehicles.py'))
    lines = capsys.readouterr().out.splitlines()
    gtmab = next(line for line in lines if line.startswith('gtmab'))
    assert ' 99.5 % by the air' in gtmab  # 413.3 g of air displaced by 415.3 g
    assert any(line.startswith('multirotor') and ' 0.0 % by the air' in line for line in lines)


def test_the_gallery_shows_every_example():
    page = (ROOT / 'docs/gallery.md').read_text(encoding='utf-8')
    examples = [path.name for path in ROOT.glob('examples/*.py')]
    assert examples
    assert all(f'](../examples/{name})' in page for name in examples)
