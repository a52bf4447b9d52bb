# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the pages tell people to type works, one command or tutorial after the other."""

import shutil

from doc_blocks import pieces, ROOT, run, stage
import pytest

PIECES = pieces(quick=False)
PATIENCE = 1800.0  # s; pages say which of their commands take minutes
# The flights that pages call by these names, by the seed of each.
FLIGHTS = {
    'A': 1,
    'B': 2,
    'C': 3,
    'D': 4,
    'BAG': 1,
    'runs/one': 1,
    'runs/two': 2,
    'runs/flight': 1,
    'runs/20261120-lamp_room-1': 1,
}


@pytest.fixture(scope='module')
def flights(tmp_path_factory):
    """Fly each seed once."""
    folder = tmp_path_factory.mktemp('flights')
    for seed in sorted(set(FLIGHTS.values())):
        run('sh', f'{ROOT}/lta simulate --seed {seed} --out {seed}', folder, PATIENCE)
    return folder


@pytest.mark.long
@pytest.mark.parametrize('name', PIECES)
def test_it_runs(name, flights, tmp_path):
    stage(tmp_path)
    for called, seed in FLIGHTS.items():
        flown = flights / str(seed)
        shutil.copytree(flown / 'bag' if called == 'BAG' else flown, tmp_path / called)
    for language, text in PIECES[name]:
        run(language, text, tmp_path, PATIENCE)
