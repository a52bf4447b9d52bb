# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whole blocks out of numbered rows, and what is lost."""

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_bridge.teensy.block_assembler import BlockAssembler, ROW_WRAP
import numpy as np
import pytest

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
        for block in blocks.add_rows(k * 1_500_000, (first + k * ROWS) % ROW_WRAP, rows(k * ROWS))
    ]


@settings(max_examples=30)
@given(st.integers(1, 400), st.sampled_from([0, ROW_WRAP - 7, ROW_WRAP - 15 * 100]))
def test_without_loss_every_row_is_in_its_place_and_time(samples, first):
    blocks = BlockAssembler(samples, 10e3)
    found = fill(blocks, range(200), first)
    assert len(found) == 200 * ROWS // samples == blocks.whole
    for k, block in enumerate(found):
        assert block.samples.tolist() == rows(k * samples, samples).tolist()
        assert block.board_ns == k * samples * 100_000
    assert (blocks.lost, blocks.torn, blocks.old) == (0, 0, 0)


@given(st.sets(st.integers(0, 60)))
def test_every_row_is_counted_once(missing):
    blocks = BlockAssembler(100, 10e3)
    numbers = [k for k in range(61) if k not in missing]
    found = fill(blocks, numbers)
    assert blocks.rows == ROWS * len(numbers)
    between = numbers and numbers[-1] - numbers[0] + 1 - len(numbers)
    assert blocks.lost == ROWS * (between or 0)
    for block in found:
        assert (np.diff(block.samples[:, 0]) == 1).all()


def test_a_board_that_counts_anew_is_followed():
    blocks = BlockAssembler(100, 10e3)
    fill(blocks, range(50, 70))
    found = fill(blocks, range(30))
    assert blocks.restarts == 1
    assert (blocks.old, blocks.lost) == (4 * ROWS, 0)
    assert found[0].board_ns == 4 * 1_500_000
    assert len(found) == (30 - 4) * ROWS // 100


def test_the_numbers_of_rows_have_32_bits():
    blocks = BlockAssembler(30, 10e3)
    assert list(blocks.add_rows(0, 2**32 - 15, rows(0))) == []
    (block,) = blocks.add_rows(1_500_000, 0, rows(15))
    assert block.samples[:, 0].tolist() == list(range(30))
    assert list(blocks.add_rows(4_500_000, 30, rows(45))) == []
    assert (blocks.lost, blocks.old, blocks.whole, blocks.torn) == (15, 0, 1, 0)


@pytest.mark.parametrize(('ahead', 'lost', 'old'), [(2**31 - 1, 2**31 - 1, 0), (2**31, 0, 15)])
def test_half_of_the_circle_ahead_is_behind(ahead, lost, old):
    blocks = BlockAssembler(100, 10e3)
    for number in (0, 15 + ahead):
        list(blocks.add_rows(0, number, rows(number)))
    assert (blocks.lost, blocks.old) == (lost, old)


def test_old_rows_between_good_ones_are_no_new_beginning():
    blocks = BlockAssembler(100, 10e3)
    fill(blocks, [100, 0, 1, 2, 3, 101, 0, 1, 2, 3, 102])
    assert (blocks.restarts, blocks.old, blocks.rows) == (0, 8 * ROWS, 3 * ROWS)
    fill(blocks, [0, 1, 2, 3, 4])  # the fifth in a row
    assert (blocks.restarts, blocks.old, blocks.rows) == (1, 12 * ROWS, 4 * ROWS)


def test_nothing_is_torn_where_no_block_is_being_filled():
    blocks = BlockAssembler(30, 10e3)
    assert len(fill(blocks, [0, 1])) == 1
    blocks.restart_row_count()
    assert (blocks.torn, blocks.restarts) == (0, 1)
    fill(blocks, [40])
    blocks.restart_row_count()
    assert (blocks.torn, blocks.lost) == (1, 0)


def test_rows_of_another_width_begin_a_block_of_their_own():
    blocks = BlockAssembler(30, 10e3)
    list(blocks.add_rows(0, 0, rows(0)))
    narrow = [rows(15)[:, :4], rows(30)[:, :4]]
    assert list(blocks.add_rows(1_500_000, 15, narrow[0])) == []
    (block,) = blocks.add_rows(3_000_000, 30, narrow[1])
    assert block.board_ns == 1_500_000
    assert block.samples.tolist() == np.concatenate(narrow).tolist()
