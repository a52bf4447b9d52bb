# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fits, estimates by hand and the sphere against figures found elsewhere."""

import math

from campaigns.sphere import morrison_drag_coefficient, relative_deviation
from hypothesis import given
from hypothesis import strategies as st
from lta_config.errors import BadInput
from lta_windtunnel.aero_fit import fit_drag
from lta_windtunnel.analytic import damping_moment, drag_force
from lta_windtunnel.reduce import standard_error
from lta_windtunnel.tunnel_model import load_tunnel_model
import numpy as np
import pytest

SPEEDS = (0.2, 0.5, 1.0, 1.5, 2.0)
RATES = (0.3, 1.0, 3.0)
AIR = (1.2, 1.5e-5)


@pytest.mark.parametrize(
    ('speeds', 'drags', 'linear', 'quadratic', 'error', 'exponent'),
    [  # a first run of this tunnel by other means, with its own fits
        (SPEEDS, (0.00464, 0.02829, 0.10645, 0.23624, 0.42624), 0.0024, 0.105, 0.030, 1.96),
        (SPEEDS, (0.01036, 0.06353, 0.23883, 0.52333, 0.91045), 0.0066, 0.230, 0.043, 1.94),
        (RATES, (1.49e-4, 1.058e-3, 6.40e-3), 3.2e-4, 6.4e-4, 0.093, 1.63),
        (RATES, (3.66e-4, 3.17e-3, 1.98e-2), 6.2e-4, 2.14e-3, 0.128, 1.73),
        (RATES, (3.86e-4, 3.27e-3, 1.99e-2), 7.0e-4, 2.14e-3, 0.134, 1.71),
    ],
)
def test_fits_are_those_found_before(speeds, drags, linear, quadratic, error, exponent):
    fit = fit_drag(speeds, drags)
    assert fit.linear == pytest.approx(linear, rel=0.02)
    assert fit.quadratic == pytest.approx(quadratic, rel=0.01)
    assert fit.error == pytest.approx(error, abs=0.005)
    assert fit.exponent == pytest.approx(exponent, abs=0.01)


@given(st.floats(0.0, 1.0), st.floats(1e-3, 10.0))
def test_a_law_is_found_again(linear, quadratic):
    fit = fit_drag(SPEEDS, [linear * v + quadratic * v**2 for v in SPEEDS])
    assert fit.linear == pytest.approx(linear, abs=1e-9)
    assert fit.quadratic == pytest.approx(quadratic, rel=1e-6)
    assert fit.error < 1e-6


def test_nothing_ever_pushes():
    fit = fit_drag(SPEEDS, [v**3 for v in SPEEDS])
    assert fit.linear == 0.0
    assert fit.quadratic > 0.0


def test_slow_points_count_as_much_as_fast_ones():
    exact = [0.1 * v**2 for v in SPEEDS]
    slow = fit_drag(SPEEDS, [exact[0] * 1.2, *exact[1:]])
    assert slow.error > 0.03  # an absolute fit would not see 20 % of the smallest force


def test_one_point_is_taken_as_quadratic():
    fit = fit_drag((2.0,), (4.0,))
    assert (fit.linear, fit.quadratic) == (0.0, 1.0)


def test_thrust_is_no_drag():
    with pytest.raises(BadInput, match='must be positive'):
        fit_drag((1.0, 2.0), (0.1, -0.2))


def test_hoerner_edge_on_and_broadside():
    # By hand with C_f = 0.005 at 1 m/s: 0.31 on 0.500 m2, 0.77 on 0.785 m2; boxes 3 % and 2 %.
    model = load_tunnel_model('gtmab')
    assert drag_force(model, 0, 1.0, AIR) / (0.6 * 0.5) == pytest.approx(0.31, rel=0.1)
    assert drag_force(model, 2, 1.0, AIR) / (0.6 * 0.785) == pytest.approx(0.77, rel=0.06)


def test_the_estimate_by_hand_is_within_a_factor_of_two_of_solved_flows():
    model = load_tunnel_model('gtmab')
    for axis, solved in ((0, 3.27e-3), (1, 3.17e-3), (2, 1.058e-3)):
        assert 0.5 < damping_moment(model, axis, 1.0, AIR) / solved < 2.0


def test_a_cigar_turns_most_easily_about_its_own_axis():
    model = load_tunnel_model('blimp2b')
    roll, pitch, yaw = (damping_moment(model, axis, 1.0, AIR) for axis in range(3))
    assert pitch == pytest.approx(yaw, rel=1e-3)
    # 0.616 pi rho R^4 sqrt(nu) (1 + 0.67 h / d) = 9.9e-5 N m with R = 0.26 m, h / d = 2.1.
    assert roll == pytest.approx(9.9e-5, rel=0.02)
    assert pitch > 10.0 * roll


def test_a_turning_disc_is_karmans():
    # 0.616 pi rho R^4 sqrt(nu w^3) = 5.6e-4 N m at 0.5 m, 1 rad/s; a sphere has 9.4e-4.
    yaw = damping_moment(load_tunnel_model('gtmab'), 2, 1.0, AIR)
    assert 5.6e-4 < yaw < 9.4e-4


@pytest.mark.parametrize(
    ('reynolds', 'coefficient'),
    [(1.33e4, 0.392), (3.33e4, 0.399), (6.67e4, 0.413), (1e5, 0.426), (1.33e5, 0.435)],
)
def test_morrison_is_morrison(reynolds, coefficient):
    assert morrison_drag_coefficient(reynolds) == pytest.approx(coefficient, abs=6e-4)


def test_within_the_scatter_nothing_is_off():
    assert relative_deviation(0.47, 1e5) == 0.0
    assert relative_deviation(0.42, 6.67e4) == 0.0
    assert relative_deviation(0.55, 1e5) == pytest.approx(0.1)
    assert relative_deviation(0.30, 6.67e4) == pytest.approx(0.30 / 0.413 - 1.0, abs=1e-3)


def test_a_standard_error_is_that_of_noise():
    noise = 1.0 + 0.1 * np.random.default_rng(3).standard_normal(4000)
    assert standard_error(noise, np.ones(4000), 100.0) == pytest.approx(0.1 / 4000**0.5, rel=0.3)


def test_of_a_history_of_less_than_a_batch_nothing_is_known():
    assert standard_error(np.ones(40), np.full(40, 0.1), 5.0) == math.inf


def test_a_standard_error_knows_that_neighbours_are_alike():
    # An AR(1) process: the variance of its mean is (1 + a) / (1 - a) times that of noise.
    generator, keep = np.random.default_rng(4), 0.95
    found = []
    for _ in range(50):
        swings = np.zeros(4000)
        for k, push in enumerate(generator.standard_normal(3999)):
            swings[k + 1] = keep * swings[k] + push
        found.append(standard_error(100.0 + swings, np.full(4000, 0.5), 200.0))
    single = 1.0 / math.sqrt(1.0 - keep**2)
    wanted = single / 100.0 * math.sqrt((1.0 + keep) / (1.0 - keep) / 4000)
    assert np.mean(found) == pytest.approx(wanted, rel=0.12)
