"""Programs that stand in for OpenFOAM."""

from pathlib import Path
import sys

from lta_sim.cfd.engine import PROGRAMS
import pytest

FAKE = Path(__file__).parent / 'sim' / 'cfd' / 'fake_openfoam.py'


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """Return a folder of cases that stand-ins for OpenFOAM will solve."""
    programs = tmp_path / 'bin'
    programs.mkdir()
    for name in PROGRAMS:
        (programs / name).write_text(f'#!/bin/sh\nexec {sys.executable} -S {FAKE} {name}\n')
        (programs / name).chmod(0o755)
    monkeypatch.setenv('PATH', f'{programs}:/usr/bin:/bin')
    return tmp_path / 'cases'
