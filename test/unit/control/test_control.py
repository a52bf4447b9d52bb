# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One step of control: cascade, allocation and duty in a chain, and the shortfall back."""

from lta_control.allocation import create_working_array
from lta_control.flight_step import has_landed
from lta_control.laws.cascade import CascadeLawConstants, CascadeLawMemory, control_step, PidGains
from lta_control.motion import CascadeMeasurement, Setpoint, step_duration
from lta_control.vehicle_parameters import build_rotors
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

from .round_gains import GAINS

ROTORS = build_rotors(load_vehicle('gtmab'))
AT_REST = CascadeMeasurement(
    altitude=0.5, climb=0.0, heading=0.0, yaw_rate=0.0, speed=0.0, sway=0.0, pitch_rate=0.0
)
HOLD = Setpoint(0.5, 0.0, 0.0)


def control(measured=AT_REST, setpoint=HOLD, memory=None, gains=None):
    constants = CascadeLawConstants(gains or GAINS, ROTORS, (0.0, 0.092))
    memory = control_step(
        constants, memory or CascadeLawMemory(), measured, setpoint, 0.01, create_working_array()
    )
    return memory.command.duties, memory


def test_every_axis_is_told_its_own_shortfall():
    """Beyond the rotors in all three: what was given less what was asked, axis by axis."""
    gains = GAINS.model_copy(
        update={
            'climb': PidGains(kp=50.0, ki=0.0, kd=0.0, limit=50.0),
            'yaw_rate': PidGains(kp=1.0, ki=0.0, kd=0.0, limit=1.0),
            'speed': PidGains(kp=10.0, ki=0.0, kd=0.0, limit=10.0),
        }
    )
    slow = AT_REST._replace(altitude=0.3, speed=-0.1)
    _, memory = control(slow, Setpoint(0.5, 0.2, 0.0), gains=gains)
    given = np.array(ROTORS.allocation).T @ memory.thrusts
    surge, heave, yaw = 10.0 * 0.1, 50.0 * 0.6 * 0.2, 0.6 * 0.2
    assert memory.shortfall == pytest.approx(
        (given[0] - surge, given[2] - heave, given[5] - yaw), rel=1e-9
    )
    assert max(memory.shortfall) < -0.1


@pytest.mark.parametrize(
    ('altitude', 'climb', 'asked', 'down'),
    [
        (0.42, 0.0, 0.30, True),
        (0.44, 0.04, 0.42, True),
        (0.46, 0.0, 0.30, False),  # still above the floor
        (0.42, -0.06, 0.30, False),  # still coming down
        (0.42, 0.0, 0.50, False),  # asked to take off
        (0.42, -0.05, 0.30, False),
        (0.42, 0.05, 0.30, False),
        (0.42, 0.0499, 0.30, True),
        (0.4499, 0.0, 0.30, True),
        (0.42 + 0.03, 0.0, 0.30, False),
    ],
)
def test_landed_is_standing_and_asked_to_be_no_higher(altitude, climb, asked, down):
    assert has_landed(altitude, climb, Setpoint(asked, 1.0, 0.0), 0.42) is down


def test_time_between_stamps():
    period = 10_000_000
    assert step_duration(None, 5, period) == 0.01
    assert step_duration(1_000_000_000, 1_030_000_000, period) == pytest.approx(
        0.03
    )  # two were lost
    assert step_duration(1_000_000_000, 9_000_000_000, period) == pytest.approx(0.1)
    # The same stamp twice, or a clock that jumped back: time goes on, but hardly.
    assert step_duration(2_000_000_000, 2_000_000_000, period) == pytest.approx(0.001)
    assert step_duration(2_000_000_000, 1_000_000_000, period) == pytest.approx(0.001)
    assert step_duration(1_000_000_000, 1_100_000_000, period) == pytest.approx(0.1)
    assert step_duration(1_000_000_000, 1_101_000_000, period) == pytest.approx(0.1)
    assert step_duration(0, 1_100_000, period) == pytest.approx(0.0011)
