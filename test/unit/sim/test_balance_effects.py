"""Values of the balance effects by hand, by point clouds, and by quadrature."""

from itertools import pairwise
import math

from lta_config.errors import BadInput
from lta_model.effects.aerodynamics import strip_damping
from lta_model.effects.protocol import RigidBody
from lta_model.effects.weight import cg_height, cg_offset, moving_mass
from lta_model.strip_geometry import build_strips, DragBox
import numpy as np
import pytest
from scipy.integrate import quad

from . import still_air as air
from .point_cloud import of_points

G = 9.80665
THRUST = (0.0,) * 8
TILTED = air.turned((0.4, 0.3, -0.2))


def named(module):
    return module.EFFECT.name


def null(module):
    return tuple(parameter.null for parameter in module.PARAMETERS)


def cloud(shift=(0.0, 0.0, 0.0)):
    generator = np.random.default_rng(5)
    masses, places = generator.uniform(0.01, 0.1, 6), generator.normal(size=(6, 3))
    return of_points(masses, places + shift, 0.4)


@pytest.mark.parametrize('module', [cg_offset, cg_height], ids=named)
def test_null_leaves_the_vehicle_to_the_bit(module):
    assert module.change_body(null(module), cloud()) == cloud()


@pytest.mark.parametrize(
    ('module', 'p', 'shift'),
    [(cg_offset, (0.02, -0.03), (0.02, -0.03, 0.0)), (cg_height, (0.04,), (0.0, 0.0, 0.04))],
)
def test_a_shifted_cg_is_every_point_shifted(module, p, shift):
    changed, expected = module.change_body(p, cloud()), cloud(shift)
    assert changed.mass == pytest.approx(expected.mass, rel=1e-14)
    for name in RigidBody._fields:
        np.testing.assert_allclose(
            getattr(changed, name), getattr(expected, name), rtol=1e-12, atol=1e-15
        )


# RGBlimp: 54.07 g, 7.47 cm ahead of and 23.8 cm below the centre of buoyancy at its zero.
MASS = (0.05407, 0.0747, 0.0006, -0.238)


def test_null_moves_nothing():
    seen = air.motion(TILTED, place=(0.1, 0.2, 0.3))
    assert (
        moving_mass.compute_wrench(null(moving_mass), (0.1, 0.2, 0.3), seen, THRUST) == (0.0,) * 6
    )
    assert moving_mass.compute_memory_rate(null(moving_mass), (0.1, 0.2, 0.3), seen) == (0.0,) * 3


def test_the_moment_is_that_of_the_weight_away_from_its_place():
    p, away = (*MASS, 0.2, 0.0), (0.04, -0.01, 0.02)
    wrench = moving_mass.compute_wrench(p, away, air.motion(TILTED), THRUST)
    expected = np.cross(away, -0.05407 * G * air.up(TILTED))
    np.testing.assert_allclose(wrench[3:], expected, rtol=1e-13)
    assert wrench[:3] == (0.0, 0.0, 0.0)
    # Level and 4 cm ahead: 54.07 g * 4 cm pitch the nose down, positive about y.
    ahead = moving_mass.compute_wrench(p, (0.04, 0.0, 0.0), air.motion(), THRUST)
    assert ahead[4] == pytest.approx(0.05407 * G * 0.04, rel=1e-14)


def test_without_lag_the_mass_is_where_it_is_told_to_be():
    told = air.motion(TILTED, place=(0.1147, 0.0006, -0.238))
    at_once = moving_mass.compute_wrench((*MASS, 0.0, 0.0), (0.0, 0.0, 0.0), told, THRUST)
    there = moving_mass.compute_wrench((*MASS, 0.2, 0.0), (0.04, 0.0, 0.0), told, THRUST)
    np.testing.assert_allclose(at_once, there, rtol=1e-12)


def test_it_follows_first_order_and_no_faster_than_its_speed():
    told = air.motion(place=(0.0747 + 0.03, 0.0006, -0.238 + 0.04))
    free = moving_mass.compute_memory_rate((*MASS, 0.2, 0.0), (0.0, 0.0, 0.0), told)
    np.testing.assert_allclose(free, (0.15, 0.0, 0.2), atol=1e-15)
    limited = moving_mass.compute_memory_rate((*MASS, 0.2, 0.1), (0.0, 0.0, 0.0), told)
    np.testing.assert_allclose(limited, (0.06, 0.0, 0.08), atol=1e-15)
    near = moving_mass.compute_memory_rate((*MASS, 0.2, 0.1), (0.027, 0.0, 0.036), told)
    np.testing.assert_allclose(near, (0.015, 0.0, 0.02), atol=1e-15)
    there = moving_mass.compute_memory_rate((*MASS, 0.2, 0.1), (0.03, 0.0, 0.04), told)
    np.testing.assert_allclose(there, (0.0, 0.0, 0.0), atol=1e-15)


def test_a_speed_limit_needs_a_lag():
    values = dict.fromkeys(('mass', 'x', 'y', 'z', 'lag', 'speed'), 0.0)
    assert moving_mass.find_conflict(values) == ''
    assert 'lag' in moving_mass.find_conflict(values | {'speed': 0.1})
    assert moving_mass.find_conflict(values | {'speed': 0.1, 'lag': 0.2}) == ''


def test_what_the_moving_mass_leaves_out_of_rgblimp():
    """The figures in its text: inertia in pitch and product, share of the recoil."""
    hull = 0.015 + 0.10482 * (0.0432**2 + 0.0079**2)
    whole = hull + 0.05407 * (0.0747**2 + 0.238**2)
    more = 0.05407 * (0.1147**2 - 0.0747**2)
    assert more == pytest.approx(4.1e-4, rel=0.01)
    assert whole == pytest.approx(1.9e-2, rel=0.03)
    assert more / whole == pytest.approx(0.022, rel=0.02)
    product, recoil = 0.05407 * 0.04 * 0.238, 0.05407 / (0.10482 + 0.05407) * 0.04
    assert product == pytest.approx(5.1e-4, rel=0.01)
    assert recoil == pytest.approx(0.014, rel=0.03)


def damping(given, seen):
    values = {parameter.name: 0.0 for parameter in strip_damping.PARAMETERS} | given
    return strip_damping.compute_wrench(tuple(values.values()), (), seen, THRUST)


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


def test_null_does_not_damp():
    seen = air.motion(velocity=(1.0, 2.0, 3.0), rates=(1.0, -2.0, 3.0))
    assert damping({}, seen) == (0.0,) * 6


@pytest.mark.parametrize('i', range(1, strip_damping.STRIPS + 1))
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


@pytest.mark.parametrize('share', [0.0, 0.3, 1.0])
def test_it_dissipates(share):
    generator = np.random.default_rng(9)
    for _ in range(300):
        given = {'translation': share}
        for i in range(1, strip_damping.STRIPS + 1):
            drag = generator.uniform(0.0, 1.0, size=3)
            given |= one(generator.normal(size=3), generator.normal(size=3), drag, i)
        v, w = generator.normal(size=(2, 3))
        wrench = damping(given, air.motion(airspeed=tuple(v), rates=tuple(w)))
        assert np.dot(wrench, (*v, *w)) < 0.0


def test_with_all_of_the_airspeed_it_is_drag_at_its_place():
    given = one((0.0, 0.0, -0.5), (0.0, 0.1, 0.0), (0.03, 0.0, 0.0)) | {'translation': 1.0}
    wrench = damping(given, air.motion(airspeed=(2.0, 0.0, 0.0)))
    np.testing.assert_allclose(wrench, (-0.12, 0.0, 0.0, 0.0, 0.06, 0.0), atol=1e-15)
    del given['translation']
    assert damping(given, air.motion(airspeed=(2.0, 0.0, 0.0))) == (0.0,) * 6


def test_a_frame_is_one_strip_and_a_panel_two():
    frame = DragBox((0.0, 0.0, -0.345), (0.1, 0.32, 0.06), 0.5)
    panel = DragBox((0.0, 0.0, 0.302), (0.178, 0.156, 0.002))
    found = build_strips([frame, panel], 1.2)
    assert [parameter.name for parameter in strip_damping.PARAMETERS] == list(found)
    assert found['half_y_1'] == 0.16
    assert found['surge_1'] == pytest.approx(0.6 * 0.5 * 0.32 * 0.06, rel=1e-14)
    assert found['sway_1'] == pytest.approx(0.6 * 0.5 * 0.1 * 0.06, rel=1e-14)
    assert found['heave_1'] == pytest.approx(0.6 * 0.5 * 0.32 * 0.1, rel=1e-14)
    assert found['y_2'] == -found['y_3'] == pytest.approx(-0.156 / math.sqrt(12.0), rel=1e-14)
    both = found['heave_2'] + found['heave_3']
    assert both == pytest.approx(0.6 * 1.17 * 0.178 * 0.156, rel=1e-14)
    assert found['heave_4'] == found['translation'] == 0.0


def test_too_many_boxes_are_refused():
    panel = DragBox((0.0, 0.0, 0.3), (0.2, 0.2, 0.002))
    with pytest.raises(BadInput, match='3 parts with drag need 6 strips'):
        build_strips([panel] * 3, 1.2)
