"""Whatever happens to a recording's bytes, every message in a chunk whose CRC holds comes back."""

from collections import Counter
import time

from lta_analysis.bag import read_bag
import numpy as np
import pytest

from .damaged_bags import damaged, DAMAGES, recordings

FEW, MANY = 100, 2500  # cases of each of four kinds of recording
PATIENCE = 20.0  # CPU seconds for a case that takes milliseconds: none may hang


@pytest.fixture(scope='module')
def whole(tmp_path_factory):
    """Return recordings by their kind."""
    return recordings(tmp_path_factory.mktemp('whole'))


def check(place, whole, kind, seed):
    rng = np.random.default_rng(seed)
    how, broken, expected = damaged(whole[kind], rng)
    (place / 'bag_0.mcap').write_bytes(broken)
    begin = time.process_time()
    bag = read_bag(place)
    found = [(log_time, data) for _, log_time, data in bag.messages()]
    assert time.process_time() - begin < PATIENCE
    everything = Counter(m for chunk in whole[kind].chunks for m in chunk.messages)
    assert not Counter(found) - everything, (kind, seed, how)
    lost = Counter(expected) - Counter(found)
    assert not lost, (kind, seed, how, bag.losses)
    if len(found) < everything.total():
        assert bag.losses, (kind, seed, how)
    if whole[kind].metadata is not None:
        (place / 'metadata.yaml').write_bytes(whole[kind].metadata)
        topics = {topic for topic, _, _ in read_bag(place).messages()}
        assert topics <= {'/lta1/a', '/lta1/b', '/c'}, (kind, seed, how)
    return how


@pytest.mark.parametrize('kind', ['ours', 'ZSTD', 'LZ4', 'NONE'])
@pytest.mark.parametrize(
    'cases', [FEW, pytest.param(MANY, marks=pytest.mark.long)], ids=['few', 'many']
)
def test_random_damage(tmp_path, whole, kind, cases):
    seen = {check(tmp_path, whole, kind, seed) for seed in range(cases)}
    assert seen == set(DAMAGES)
