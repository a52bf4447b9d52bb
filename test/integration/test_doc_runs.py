"""What the pages tell people to type does what they say: every block, one after the other."""

import shutil

from doc_blocks import blocks, ROOT, run, stage
import pytest

BLOCKS = [block for block in blocks() if block.runs(quick=False)]
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
@pytest.mark.parametrize('block', BLOCKS, ids=str)
def test_a_block_runs(block, flights, tmp_path):
    stage(tmp_path)
    for name, seed in FLIGHTS.items():
        shutil.copytree(flights / str(seed), tmp_path / name)
    for text in block.runs(quick=False):
        run(block.language, text, tmp_path, PATIENCE)
