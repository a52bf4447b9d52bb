# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a notebook may pass to `lta_analysis`: numbers of numpy and paths; a word is refused."""

import lta_analysis
from lta_config.errors import BadInput
from lta_config.files import find_file
import numpy as np
import pytest

from ..report_flight import write_flight  # noqa: TID252 - `test` is Python's own


def test_a_path_and_a_numpy_number_are_as_good_as_a_name_and_an_int():
    named = lta_analysis.fly_grid({'scenario.goal.time_limit': ['1 s']}, seeds=1)
    by_path = lta_analysis.fly_grid(
        {'scenario.goal.time_limit': ['1 s']},
        seeds=np.int64(1),
        vehicle=find_file('vehicle', 'gtmab'),
        scenario=find_file('scenario', 'lamp_room'),
    )
    assert by_path == named
    assert lta_analysis.fly_grid({'scenario.goal.time_limit': '1 s'}) == named  # not its letters
    assert [row['seed'] for row in named] == [1]


@pytest.mark.parametrize('seed', ['x', 1.5, -1, None])
def test_a_seed_that_is_no_whole_number_is_refused(seed, tmp_path):
    with pytest.raises(BadInput, match=f'seed is {seed!r}, but must be '):
        lta_analysis.simulate(seed=seed, out=tmp_path / 'out')
    with pytest.raises(BadInput, match=f'seeds is {seed!r}, but must be '):
        lta_analysis.fly_grid({}, seeds=seed)
    assert not (tmp_path / 'out').exists()


def test_what_is_no_text_or_mapping_is_refused(tmp_path):
    flight = lta_analysis.open(write_flight(tmp_path / 'bag'))
    with pytest.raises(BadInput, match=r"The topic is \['odom'\], but must be a text"):
        flight.align_topics(['odom'], rate=50.0)
    with pytest.raises(BadInput, match='source is 3, but must be the path of a recording'):
        lta_analysis.open(3)
    with pytest.raises(BadInput, match='values is 3, but must be lists of values by path'):
        lta_analysis.fly_grid(3)
