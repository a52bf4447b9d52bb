"""Whole blocks out of numbered rows, and what is lost."""

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_bridge.teensy.blocks import Blocks, WRAP
import numpy as np

ROWS = 15


def rows(first, count=ROWS):
    """Return rows whose values are their numbers."""
    numbers = (first + np.arange(count)) % 4096
    return np.repeat(numbers[:, None], 8, axis=1).astype(np.uint16)


def fill(blocks, numbers, first=0):
    """Hand in the messages of these numbers, 15 rows each at 10 kHz."""
    return [
        block
        for k in numbers
        for block in blocks.take(k * 1_500_000, (first + k * ROWS) % WRAP, rows(k * ROWS))
    ]


@settings(max_examples=30)
@given(st.integers(1, 400), st.sampled_from([0, WRAP - 7, WRAP - 15 * 100]))
def test_without_loss_every_row_is_in_its_place_and_time(samples, first):
    blocks = Blocks(samples, 10e3)
    found = fill(blocks, range(200), first)
    assert len(found) == 200 * ROWS // samples == blocks.whole
    for k, block in enumerate(found):
        assert block.samples.tolist() == rows(k * samples, samples).tolist()
        assert block.board_ns == k * samples * 100_000
    assert (blocks.lost, blocks.torn, blocks.old) == (0, 0, 0)


def test_a_gap_takes_its_block_and_the_next_begins_after_it():
    blocks = Blocks(100, 10e3)
    numbers = [k for k in range(40) if k not in (10, 11)]
    found = fill(blocks, numbers)
    # 150 rows came, 30 did not: block 0 is whole, 50 rows are torn, and it goes on at row 180.
    assert [block.board_ns // 100_000 for block in found] == [0, 180, 280, 380, 480]
    assert found[1].samples[:, 0].tolist() == list(range(180, 280))
    assert (blocks.lost, blocks.torn, blocks.rows) == (30, 1, 38 * ROWS)


@given(st.sets(st.integers(0, 60)))
def test_every_row_is_counted_once(missing):
    blocks = Blocks(100, 10e3)
    numbers = [k for k in range(61) if k not in missing]
    found = fill(blocks, numbers)
    assert blocks.rows == ROWS * len(numbers)
    between = numbers and numbers[-1] - numbers[0] + 1 - len(numbers)
    assert blocks.lost == ROWS * (between or 0)
    for block in found:
        assert (np.diff(block.samples[:, 0]) == 1).all()


def test_what_comes_twice_or_late_is_left():
    blocks = Blocks(100, 10e3)
    found = fill(blocks, [0, 1, 1, 2, 0, 3, 4, 5, 6])
    assert len(found) == 1
    assert (blocks.old, blocks.lost, blocks.rows) == (2 * ROWS, 0, 7 * ROWS)


def test_a_board_that_counts_anew_is_followed():
    blocks = Blocks(100, 10e3)
    fill(blocks, range(50, 70))
    found = fill(blocks, range(30))
    assert blocks.restarts == 1
    assert (blocks.old, blocks.lost) == (4 * ROWS, 0)
    assert found[0].board_ns == 4 * 1_500_000
    assert len(found) == (30 - 4) * ROWS // 100
