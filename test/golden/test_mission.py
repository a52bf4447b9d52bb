# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The summer day that docs/mission.md quotes is found again, by one of its seeds and schedules."""

import json
from pathlib import Path

import pytest

STORED = json.loads((Path(__file__).parent / 'mission_summer.json').read_text(encoding='utf-8'))
SCHEDULE = 'duty cycle'


@pytest.mark.long
def test_a_stored_day_is_found_again(call, tmp_path):
    """Within the rounding of the page: a day is chaotic in the last bits of another processor."""
    words = ('mission', 'greenhouse_summer', '--schedule', SCHEDULE, '--json')
    status, said = call(*words, '--out', tmp_path / 'day')
    assert status == 0
    (life,) = json.loads(said.out)['lives']
    (told,) = (
        each for each in STORED['lives'] if (each['schedule'], each['seed']) == (SCHEDULE, 1)
    )
    assert life['flown'] == pytest.approx(told['flown'], abs=60.0)  # s
    assert life['harvested'] == pytest.approx(told['harvested'], abs=100.0)  # J
    assert life['flights'] == pytest.approx(told['flights'], abs=1)
    assert life['failures'] == told['failures'] == {}
