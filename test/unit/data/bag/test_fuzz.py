"""Whatever happens to a recording's bytes, every message in a chunk whose CRC holds comes back."""

from collections import Counter
import tracemalloc

from lta_config.errors import BadInput
from lta_config.limits import CHUNK_BYTES
from lta_data.bag import read_bag
from lta_data.bag.recover import recover_bag
from mcap.reader import make_reader
import numpy as np
import pytest
from rosbags.rosbag2 import Reader

from .damaged_bags import damaged, DAMAGES, recordings

FEW, MANY = 50, 2500  # cases of each of four kinds of recording
FEW_MENDED, MANY_MENDED = 8, 250
# Bytes that reading may take at most: an lz4 frame whose size is spoilt gets the room of a chunk;
# sound recordings of some kilobytes take 1 MB.
MEMORY = CHUNK_BYTES + 8_000_000


@pytest.fixture(scope='module')
def whole(tmp_path_factory):
    """Return recordings by their kind."""
    return recordings(tmp_path_factory.mktemp('whole'))


def check(place, whole, kind, seed):
    rng = np.random.default_rng(seed)
    how, broken, expected = damaged(whole[kind], rng)
    (place / 'bag_0.mcap').write_bytes(broken)
    tracemalloc.start()
    bag = read_bag(place)
    found = [(log_time, data) for _, log_time, data in bag.iterate_messages()]
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < MEMORY, (kind, seed, how, peak)
    everything = Counter(m for chunk in whole[kind].chunks for m in chunk.messages)
    assert not Counter(found) - everything, (kind, seed, how)
    lost = Counter(expected) - Counter(found)
    assert not lost, (kind, seed, how, bag.losses)
    if len(found) < everything.total():
        assert bag.losses, (kind, seed, how)
    return how


@pytest.mark.parametrize('kind', ['ours', 'ZSTD', 'LZ4', 'NONE'])
@pytest.mark.parametrize(
    'cases', [FEW, pytest.param(MANY, marks=pytest.mark.long)], ids=['few', 'many']
)
def test_random_damage(tmp_path, whole, kind, cases):
    seen = {check(tmp_path, whole, kind, seed) for seed in range(cases)}
    assert seen == set(DAMAGES)


@pytest.mark.parametrize('kind', ['ours', 'ZSTD', 'LZ4', 'NONE'])
@pytest.mark.parametrize(
    'cases', [FEW_MENDED, pytest.param(MANY_MENDED, marks=pytest.mark.long)], ids=['few', 'many']
)
def test_what_is_mended_is_whole_to_everybody(tmp_path, whole, kind, cases):
    for seed in range(1000, 1000 + cases):
        how, broken, expected = damaged(whole[kind], np.random.default_rng(seed))
        source, made = tmp_path / f'{seed}.mcap', tmp_path / str(seed)
        source.write_bytes(broken)
        bag = read_bag(source)
        found = list(bag.iterate_messages())
        try:
            told = recover_bag(source, made)
        except BadInput:
            assert not found or (bag.is_complete and bag.is_indexed), (kind, seed, how)
            continue
        assert told.messages == len(found) >= len(expected)
        mended = read_bag(made)
        assert (mended.losses, list(mended.iterate_messages())) == ([], found), (kind, seed, how)
        with Reader(made) as reader:
            theirs = [(link.topic, time, data) for link, time, data in reader.messages()]
        assert Counter(theirs) == Counter(found)
        with (made / f'{seed}_0.mcap').open('rb') as stream:
            messages = make_reader(stream, validate_crcs=True).iter_messages()
            assert Counter((c.topic, m.log_time, m.data) for _, c, m in messages) == Counter(found)
