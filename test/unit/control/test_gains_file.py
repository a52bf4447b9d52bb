# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The shipped gains say everything."""

from lta_config.files import find_file, load_yaml
from lta_control.laws import load_gains
from lta_control.laws.cascade import CascadeGains, PidGains
import pytest

HEAD = '/**/controller'


@pytest.fixture
def shipped():
    return load_yaml(find_file('gains', 'gtmab'))[HEAD]['ros__parameters']['gains']


def test_no_gain_of_gtmab_is_silently_a_default(shipped):
    assert set(shipped) == set(CascadeGains.model_fields)
    for loop in ('climb', 'yaw_rate', 'speed'):
        assert set(shipped[loop]) == set(PidGains.model_fields)


def test_the_numbers_arrive(shipped):
    gains = load_gains('gtmab')
    assert gains.model_dump() == shipped
    assert gains.yaw_rate == PidGains(kp=0.08, ki=0.02, kd=0.0, limit=0.008)
