# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A dozen faults in three whole graphs: what `make campaign chaos` does with each, many times."""

from campaigns.chaos import TOGETHER
from campaigns.harness import Case, try_alone
import pytest

LIMIT = 600.0  # s; twenty where nobody else works


@pytest.mark.parametrize(
    'way',
    [pytest.param(way, marks=() if way == 'lockstep' else pytest.mark.long) for way in TOGETHER],
)
def test_each_fault_is_named_and_survived_or_ends_in_order(way):
    outcome = try_alone('chaos', Case(f'together {way}', 0), (), LIMIT)
    assert outcome['wrong'] == '', outcome


def test_they_are_a_dozen_kinds():
    kinds = [kind for some in TOGETHER.values() for kind in some]
    assert len(kinds) == len(set(kinds)) == 12
