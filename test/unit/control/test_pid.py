# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One PID loop: each term by hand, and that neither kind of saturation winds it up."""

from typing import NamedTuple

from lta_control.laws.cascade import pid_step
import pytest

WIDE = 1e9


class Gains(NamedTuple):
    """Gains as a law has them, but of any size."""

    kp: float
    ki: float
    kd: float
    limit: float


def step(gains, integral=0.0, error=0.0, rate=0.0, shortfall=0.0, dt=0.1, lowest=-WIDE):
    return pid_step(gains, integral, error, rate, shortfall, dt, lowest)


def test_proportional_term():
    assert step(Gains(2.0, 0.0, 0.0, WIDE), error=-0.3) == (pytest.approx(-0.6), 0.0)


def test_integral_term_works_from_the_next_step_on():
    gains = Gains(2.0, 0.5, 0.0, WIDE)
    output, integral = step(gains, integral=0.7, error=0.4)
    assert output == pytest.approx(2.0 * 0.4 + 0.7)
    assert integral == pytest.approx(0.7 + 0.1 * 0.5 * 0.4)


def test_derivative_brakes_the_measurement():
    output, integral = step(Gains(2.0, 0.5, 3.0, WIDE), error=0.1, rate=0.2)
    assert output == pytest.approx(2.0 * 0.1 - 3.0 * 0.2)
    assert integral == pytest.approx(0.1 * 0.5 * 0.1)  # the derivative is not integrated


def test_the_limit_of_the_gains_holds_below_a_lower_lowest_output():
    assert step(Gains(2.0, 0.0, 0.0, 1.5), error=-5.0, lowest=-9.0)[0] == -1.5


def test_back_calculation_from_the_own_limit():
    # wanted 2 * 1 + 0.5 = 2.5, allowed 1.5: the excess of 1 unwinds at ki / kp = 0.25 /s.
    _, integral = step(Gains(2.0, 0.5, 0.0, 1.5), integral=0.5, error=1.0)
    assert integral == pytest.approx(0.5 + 0.1 * (0.5 * 1.0 + 0.25 * (1.5 - 2.5)))


def test_back_calculation_from_the_stage_below():
    _, integral = step(Gains(2.0, 0.5, 0.0, WIDE), integral=0.5, error=1.0, shortfall=-0.8)
    assert integral == pytest.approx(0.5 + 0.1 * (0.5 * 1.0 - 0.25 * 0.8))


def test_without_a_proportional_gain_nothing_unwinds():
    _, integral = step(Gains(0.0, 0.5, 0.0, 0.1), integral=0.5, error=1.0, shortfall=-1.0)
    assert integral == pytest.approx(0.55)
