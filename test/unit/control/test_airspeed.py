# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Airspeed: steady state by the drag model, and why the accelerometer alone will not do."""

import math

from lta_control.motion_filters import airspeed_step, AirspeedEstimate, HullDragModel
import numpy as np
import pytest
from scipy.integrate import solve_ivp

HULL = HullDragModel(mass=(0.55, 0.6), linear=(0.01, 0.02), quadratic=(0.092, 0.1))
DT = 0.01
NONE = (0.0, 0.0)


def fly(
    steps,
    force=NONE,
    acceleration=NONE,
    rate=0.0,
    trust=1.0,
    start=AirspeedEstimate(),  # noqa: B008 - immutable
    dt=DT,
):
    state = start
    for _ in range(steps):
        state = airspeed_step(HULL, state, force, acceleration, rate, trust, dt)
    return state


def test_a_steady_thrust_gives_the_speed_at_which_drag_holds_it():
    state = fly(12000, force=(0.0277, -0.035))
    # 0.01 u + 0.092 u^2 = 0.0277 and 0.02 v + 0.1 v^2 = 0.035, by hand.
    surge = (-0.01 + math.sqrt(0.01**2 + 4 * 0.092 * 0.0277)) / (2 * 0.092)
    assert state.surge == pytest.approx(surge, rel=1e-6)
    assert state.sway == pytest.approx(-0.5, rel=1e-6)
    assert (state.model_surge, state.model_sway) == pytest.approx((surge, -0.5), rel=1e-6)


def test_a_damped_integral_alone_decays_and_this_does_not():
    """Accelerate to 0.5 m/s in 2 s, then cruise: no acceleration is left to integrate."""
    force = 0.01 * 0.5 + 0.092 * 0.25
    state, alone = AirspeedEstimate(), 0.0
    for k in range(3000):
        a = 0.25 if k < 200 else 0.0
        push = force if k >= 200 else 0.55 * 0.25 + 0.01 * state.model_surge
        state = airspeed_step(HULL, state, (push, 0.0), (a, 0.0), 0.0, 1.0, DT)
        alone += DT * (a - alone / 1.0)
        if k == 200:
            early = alone
    assert early > 0.15
    assert alone < 1e-6
    assert state.surge == pytest.approx(0.5, abs=0.01)


def test_the_model_is_that_of_a_body_with_added_mass():
    """Kirchhoff's equations in the plane, by an independent integrator."""
    rate, force = 0.4, (0.03, 0.005)

    def slope(_, nu):
        u, v = nu
        drag = [(HULL.linear[i] + HULL.quadratic[i] * abs(x)) * x for i, x in enumerate(nu)]
        return (
            (force[0] - drag[0] + HULL.mass[1] * v * rate) / HULL.mass[0],
            (force[1] - drag[1] - HULL.mass[0] * u * rate) / HULL.mass[1],
        )

    start = AirspeedEstimate(model_surge=0.3, model_sway=-0.1)
    state = fly(4000, force=force, rate=rate, start=start, dt=0.0005)
    exact = solve_ivp(slope, (0.0, 2.0), (0.3, -0.1), rtol=1e-10, atol=1e-12).y[:, -1]
    np.testing.assert_allclose((state.model_surge, state.model_sway), exact, atol=1e-4)
