# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Six faults in flight, side by side: what `make campaign faults` does with all, many times."""

from concurrent.futures import ThreadPoolExecutor

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
