"""Thrust of a rotor in flight, against its measured figures and momentum theory."""

import math
from pathlib import Path
import sys

import pytest


@pytest.fixture
def rotor(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parent))
    import rotor_advance

    yield rotor_advance
    sys.modules.pop('rotor_advance', None)


@pytest.mark.parametrize('slope', [3.5, math.tau])
def test_at_rest_it_has_the_measured_thrust_and_power(slope, rotor):
    section = rotor.fit_section(slope)
    assert rotor.compute_coefficients(section, 0.0) == pytest.approx(rotor.AT_REST, rel=1e-4)
    # Blades of thin plates at this Reynolds number
    assert -0.1 < section.zero_lift < 0.05
    assert 0.03 < section.drag < 0.1


@pytest.mark.parametrize(('thrust', 'speed'), [(0.159, 0.76), (0.02, 0.5)])
def test_thrust_falls_as_momentum_theory_says(thrust, speed, rotor):
    sections = map(rotor.fit_section, rotor.LIFT_SLOPES)
    shares = [rotor.thrust_shares(section, thrust, speed)[2] for section in sections]
    # An ideal disc of constant power P = T (V / 2 + sqrt(V^2 / 4 + T / (2 rho A)))
    area, density = math.pi * 0.047**2 / 4.0, 1.2041
    at_rest = thrust * math.sqrt(thrust / (2.0 * density * area))
    low, high = 0.5 * thrust, thrust
    for _ in range(60):
        middle = 0.5 * (low + high)
        root = math.sqrt(0.25 * speed**2 + middle / (2.0 * density * area))
        low, high = (middle, high) if middle * (0.5 * speed + root) < at_rest else (low, middle)
    loss = 1.0 - low / thrust
    # Blades lose as much as the ideal disc, or up to 1.6 times as much
    assert all(0.9 * loss < 1.0 - share < 1.6 * loss for share in shares)
