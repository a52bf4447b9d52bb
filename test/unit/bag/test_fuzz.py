# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whatever happens to a recording's bytes, every message in a chunk whose CRC holds comes back."""

from collections import Counter
import tracemalloc

from lta_bag.reader import read_bag
from lta_config.limits import CHUNK_BYTES
import numpy as np
import pytest

from .damaged_bags import damaged, DAMAGES, recordings

FEW, MANY = 50, 2500  # cases of each of four kinds of recording
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
    # No checksum tells of what is flipped in a chunk that is cut off
    assert how == 'both' or not Counter(found) - everything, (kind, seed, how)
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
