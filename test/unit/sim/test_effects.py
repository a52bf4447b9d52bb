# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Values of lift and balance effects by hand and by quadrature, and what may be an effect."""

from itertools import pairwise
import math

from lta_config.errors import BadInput
from lta_model import effects
from lta_model.effect_parameters import build_strips, DragBox
from lta_model.effects.drag import MOST_STRIPS, STRIP_DAMPING
from lta_model.effects.gas import AIR_STATE, GAS_PURITY, GAS_STATE, SUPERHEAT
from lta_model.effects.protocol import EffectParameter, RigidBody, WrenchEffect
from lta_model.effects.weight import MOVING_MASS, WEIGHT_AND_BUOYANCY
import numpy as np
import pytest
from scipy.integrate import quad
from tools.reference.effects import render_page

from . import still_air as air

G = 9.80665
THRUST = (0.0,) * 8
# The mylar shape of 1 m: 0.343225 m3 of air at 20 C, and what R = 2077.1 J/(kg K) makes of helium.
VOLUME, AIR = 0.343225, 1.2041
HELIUM = 101325.0 / (2077.1 * 293.15)
VEHICLE = RigidBody(
    0.413, (0.001, -0.002, -0.03), (0.03, 0.031, 0.032, 1e-4, 2e-4, 3e-4), VOLUME * AIR
)
TILTED = air.turned((0.4, 0.3, -0.2))


def test_superheat_is_the_weight_of_the_air_that_slack_gas_displaces():
    """A mass of helium at the pressure of the air, 293.15 K and then 9 K warmer."""
    gas = HELIUM * VOLUME
    cold, warm = (gas * 2077.1 * kelvin / 101325.0 for kelvin in (293.15, 302.15))
    seen = air.motion(TILTED, displaced=VOLUME * AIR)
    wrench = SUPERHEAT.wrench((0.02, 70.0, 1.0), (9.0,), seen, THRUST)
    np.testing.assert_allclose(wrench[:3], (warm - cold) * AIR * G * air.up(TILTED), rtol=1e-12)
    assert SUPERHEAT.wrench((0.02, 70.0, 0.0), (9.0,), seen, THRUST) == (0.0,) * 6
    half = SUPERHEAT.wrench((0.02, 70.0, 0.5), (9.0,), seen, THRUST)
    np.testing.assert_allclose(half, 0.5 * np.array(wrench), rtol=1e-14)


def density(pascal, kelvin):
    return pascal / (287.05 * kelvin)


@pytest.mark.parametrize(('pascal', 'kelvin'), [(1500.0, 0.0), (0.0, 8.0), (-3e3, -12.0)])
def test_a_taut_hull_displaces_air_of_the_new_density(pascal, kelvin):
    changed = AIR_STATE.change((pascal, kelvin, 0.0), VEHICLE)
    ratio = density(101325.0 + pascal, 293.15 + kelvin) / density(101325.0, 293.15)
    assert changed.displaced == pytest.approx(ratio * VEHICLE.displaced, rel=1e-14)
    assert changed[:3] == VEHICLE[:3]


def test_a_slack_hull_displaces_the_same_mass_of_any_air():
    assert AIR_STATE.change((-5e3, 20.0, 1.0), VEHICLE) == VEHICLE


def test_gas_follows_the_gas_law_at_the_volume_of_the_hull():
    gas = HELIUM * VOLUME
    changed = GAS_STATE.change((gas, 6.0, 800.0), VEHICLE)
    filled = 102125.0 * VOLUME / (2077.1 * 299.15)
    assert changed.mass - VEHICLE.mass == pytest.approx(filled - gas, rel=1e-9)
    assert changed[1:] == VEHICLE[1:]
    assert GAS_STATE.change((gas, 0.0, 0.0), VEHICLE) == VEHICLE


def test_air_in_the_helium_weighs():
    changed = GAS_PURITY.change((-0.07,), VEHICLE)
    heavier = 0.07 * VOLUME * (AIR - 0.1664)
    assert changed.mass - VEHICLE.mass == pytest.approx(heavier, rel=1e-12)
    assert heavier == pytest.approx(0.0249, rel=2e-3)
    assert changed[1:] == VEHICLE[1:]


def test_a_speed_limit_needs_a_lag():
    values = dict.fromkeys(('mass', 'x', 'y', 'z', 'lag', 'speed'), 0.0)
    assert MOVING_MASS.check(values) == ''
    assert 'lag' in MOVING_MASS.check(values | {'speed': 0.1})
    assert MOVING_MASS.check(values | {'speed': 0.1, 'lag': 0.2}) == ''


def damping(given, seen):
    values = {parameter.name: 0.0 for parameter in STRIP_DAMPING.parameters} | given
    return STRIP_DAMPING.wrench(tuple(values.values()), (), seen, THRUST)


def by_quadrature(centre, half, drag, u, w):
    """Return moment and force of one strip, integrated adaptively."""

    def at(s):
        r = np.array(centre) + s * np.array(half)
        local = np.array(u) + np.cross(w, r)
        force = -np.array(drag) * abs(local) * local
        return 0.5 * np.concatenate([force, np.cross(r, force)])

    # Split where a component of the velocity changes sign, so that the quadrature is exact.
    a, b = np.array(u) + np.cross(w, centre), np.cross(w, half)
    kinks = [-x / y for x, y in zip(a, b, strict=True) if y and abs(x) < abs(y)]
    edges = [-1.0, *sorted(kinks), 1.0]
    return [
        sum(
            quad(lambda s, k=k: at(s)[k], lo, hi, epsabs=1e-15, epsrel=1e-12)[0]
            for lo, hi in pairwise(edges)
        )
        for k in range(6)
    ]


NAMES = ('x', 'y', 'z', 'half_x', 'half_y', 'half_z', 'surge', 'sway', 'heave')


def one(centre, half, drag, i=1):
    return {
        f'{name}_{i}': value for name, value in zip(NAMES, (*centre, *half, *drag), strict=True)
    }


@pytest.mark.parametrize('i', range(1, MOST_STRIPS + 1))
def test_a_strip_beside_the_axis_is_integrated_exactly(i):
    centre, half, drag = (0.5, 0.1, -0.4), (0.1, 0.02, 0.05), (0.01, 0.02, 0.03)
    u, w = (0.0, 0.0, 0.0), (0.1, 0.6, 0.7)
    local = [np.cross(w, np.array(centre) + s * np.array(half)) for s in (-1.0, 1.0)]
    assert np.all(local[0] * local[1] > 0.0), 'no kink, so three points are exact'
    wrench = damping(one(centre, half, drag, i), air.motion(rates=w))
    expected = by_quadrature(centre, half, drag, u, w)
    np.testing.assert_allclose(wrench[3:], expected[3:], rtol=1e-12)
    assert wrench[:3] == (0.0, 0.0, 0.0), 'translation is in the drag of the hull'


def test_a_bar_about_its_own_middle_by_hand():
    """A bar of 2 L: moment D L^3 w^2 / 4, which three points give 3.3 % high."""
    wrench = damping(
        one((0.0,) * 3, (0.0, 0.2, 0.0), (0.02, 0.0, 0.0)), air.motion(rates=(0, 0, 3.0))
    )
    exact = -0.02 * 0.2**3 * 9.0 / 4.0
    assert wrench[5] == pytest.approx(exact * 2.0 * (5.0 / 9.0) * 0.6**1.5 / 0.5, rel=1e-12)
    assert wrench[5] == pytest.approx(exact, rel=0.033)


def test_the_kink_costs_little_in_any_turn():
    """Three points against adaptive quadrature, over strips anywhere and turns about any axis."""
    generator = np.random.default_rng(8)
    worst = 0.0
    for _ in range(40):
        centre, half = generator.normal(size=3), generator.normal(size=3)
        drag, w = generator.uniform(0.0, 1.0, size=3), generator.normal(size=3)
        wrench = damping(one(centre, half, drag), air.motion(rates=tuple(w)))
        expected = np.array(by_quadrature(centre, half, drag, (0.0,) * 3, w))
        scale = np.linalg.norm(expected[3:])
        worst = max(worst, np.linalg.norm(expected[3:] - wrench[3:]) / scale)
    assert worst < 0.04


def test_a_frame_is_one_strip_and_a_panel_two():
    frame = DragBox((0.0, 0.0, -0.345), (0.1, 0.32, 0.06), 0.5)
    panel = DragBox((0.0, 0.0, 0.302), (0.178, 0.156, 0.002))
    found = build_strips([frame, panel], 1.2)
    assert [parameter.name for parameter in STRIP_DAMPING.parameters] == list(found)
    assert found['half_y_1'] == 0.16
    assert found['surge_1'] == pytest.approx(0.6 * 0.5 * 0.32 * 0.06, rel=1e-14)
    assert found['sway_1'] == pytest.approx(0.6 * 0.5 * 0.1 * 0.06, rel=1e-14)
    assert found['heave_1'] == pytest.approx(0.6 * 0.5 * 0.32 * 0.1, rel=1e-14)
    assert found['y_2'] == -found['y_3'] == pytest.approx(-0.156 / math.sqrt(12.0), rel=1e-14)
    both = found['heave_2'] + found['heave_3']
    assert both == pytest.approx(0.6 * 1.17 * 0.178 * 0.156, rel=1e-14)
    assert found['heave_4'] == found['translation'] == 0.0


POUNDS = EffectParameter('pull', 'lbf', 0.0, 0.0, 1.0, 0.1, 'nobody: a unit that no file knows')


class Point:
    """An entry point that names `effect`."""

    def __init__(self, effect):
        self.name, self.value, self._effect = 'point', 'somewhere:EFFECT', effect

    def load(self):
        return self._effect


@pytest.mark.parametrize(
    ('effect', 'words'),
    [
        (effects.EFFECTS['linear_drag'], 'linear_drag of somewhere:EFFECT is already used'),
        ('wind', 'not an effect'),
        (WrenchEffect('side-wind', (), WEIGHT_AND_BUOYANCY.wrench), 'underscores'),
        (
            WrenchEffect('tow', (POUNDS,), WEIGHT_AND_BUOYANCY.wrench),
            "tow.pull .* has the unit 'lbf'",
        ),
    ],
)
def test_installed_effects_are_checked(monkeypatch, effect, words):
    monkeypatch.setattr(effects, 'entry_points', lambda group: [Point(effect)])
    with pytest.raises(BadInput, match=words):
        effects.merge_installed_effects({'linear_drag': effects.EFFECTS['linear_drag']})


def test_what_others_install_is_not_of_the_library(monkeypatch):
    rope = WrenchEffect('not_shipped', (), WEIGHT_AND_BUOYANCY.wrench)
    before = render_page()
    monkeypatch.setitem(effects.EFFECTS, 'not_shipped', rope)
    assert effects.get_effect('not_shipped') is rope
    assert list(effects.select_built_in_effects()) == list(effects.BUILT_IN)
    assert render_page() == before
