# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Some faults of the campaigns, injected in flights that run side by side."""

from concurrent.futures import ThreadPoolExecutor

from campaigns.chaos import TOGETHER
from campaigns.harness import Case, try_alone
import pytest

CASES = [
    ('silent', 0),
    ('dumb', 1),
    ('killed', 1),
    ('ended', 0),
    ('hung', 0),
    ('rises', 0),
]  # even by duties, odd by setpoints
PATIENCE = 240.0  # s; half a minute where nobody else works


@pytest.mark.long
def test_the_motors_stand_and_the_bag_tells_why():
    def fly(case):
        return try_alone('faults', Case(*case), (), PATIENCE)

    with ThreadPoolExecutor(len(CASES)) as pool:
        outcomes = list(pool.map(fly, CASES))
    assert [outcome['wrong'] for outcome in outcomes] == [''] * len(CASES), outcomes


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
