# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Drag against measured spheres; cross flow, Munk moment and lift of a hull by hand.

Data: 122 drag coefficients against Reynolds numbers from 5 to 118 000 (atrettel/sheardata,
CC-BY-4.0), looked for in `../shared/data/sphere_drag` beside the project. Correlation: Morrison
2013, An Introduction to Fluid Mechanics; "Data Correlation for Drag Coefficient for Sphere", 2016.
"""

import math
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st
from lta_model.effects.added_mass import MUNK_MOMENT
from lta_model.effects.drag import CROSS_FLOW
from lta_model.effects.hull_lift import HULL_LIFT, OBLIQUE_LIFT, SMALL_SPEED
from lta_model.effects.protocol import VehicleMotion
from lta_model.mass_properties import half_axes
from lta_model.rigid_body import cross_product
from lta_model.state import ADDED, BODY
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

RHO = 1.2041
DATA = Path(__file__).resolve().parents[4] / 'shared' / 'data' / 'sphere_drag' / 'spheres.csv'
HULL_RANGE = (1e4, 1.2e5)  # a metre of hull at 0.15 m/s, to the end of the data


@pytest.fixture(scope='module')
def measured():
    if not DATA.exists():
        pytest.skip(f'the measured spheres are not at {DATA.parent}')
    return np.genfromtxt(DATA, delimiter=',', skip_header=1, usecols=(0, 1)).T


def morrison(re):
    low, high, far = re / 5.0, re / 2.63e5, re / 1e6
    creeping = 24.0 / re + 2.6 * low / (1.0 + low**1.52)
    return creeping + 0.411 * high**-7.94 / (1.0 + high**-8.0) + 0.25 * far / (1.0 + far)


def skye():
    """Return radius and drag coefficient of the one spherical hull that is shipped."""
    vehicle = load_vehicle('skye')
    radius = half_axes(vehicle.file.hull)[0]
    drag = vehicle.collect_effects()['quadratic_drag']['surge']
    return radius, drag / (0.5 * RHO * math.pi * radius**2)


def rms(values):
    return math.sqrt(np.mean(np.square(values)))


def test_skye_has_the_drag_of_the_measured_spheres(measured):
    """A constant of 0.47 is within 7 % rms of 33 spheres, and 3 % below them on average."""
    re, cd = measured
    there = (re >= HULL_RANGE[0]) & (re <= HULL_RANGE[1])
    _, constant = skye()
    error = constant / cd[there] - 1.0
    assert there.sum() == 33
    assert rms(error) == pytest.approx(0.066, abs=0.002)
    assert np.mean(error) == pytest.approx(-0.032, abs=0.002)
    # What is left is the scatter of the spheres themselves.
    assert np.std(cd[there]) / np.mean(cd[there]) == pytest.approx(0.057, abs=0.002)


def test_the_correlation_holds_below_a_hull_and_not_there(measured):
    """Morrison's curve is 4 % rms from Re 100 to 1000, and 17 % low from 1e4 on."""
    re, cd = measured
    error = morrison(re) / cd - 1.0
    assert rms(error[(re >= 100.0) & (re < 1e3)]) == pytest.approx(0.036, abs=0.002)
    assert np.mean(error[re >= 1e4]) == pytest.approx(-0.174, abs=0.002)


LEVEL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
NO = (0.0, 0.0, 0.0)
REST = (0.0,) * 8
ADDED_MASS = (0.05, 0.13, 0.2)
number = st.floats(-3.0, 3.0, allow_subnormal=False)
vectors = st.tuples(number, number, number)
share = st.floats(0.0, 1.0)


def flown(airspeed, rates=NO):
    body = [0.0] * BODY
    body[ADDED : ADDED + 3] = ADDED_MASS
    return VehicleMotion(NO, LEVEL, airspeed, rates, airspeed, tuple(body), (0.0,) * 11, REST)


def missing(p, airspeed):
    return np.array(CROSS_FLOW.wrench(p, (), flown(airspeed), REST))


def too_much(lost, airspeed):
    return np.array(MUNK_MOMENT.wrench((lost,), (), flown(airspeed), REST))


def axis_by_axis(drag, airspeed):
    return np.array([-d * abs(v) * v for d, v in zip(drag, airspeed, strict=True)])


@pytest.mark.parametrize('angle', [0.0, 0.3, math.pi / 4, 2.0, -1.2])
def test_a_round_hull_has_the_same_drag_all_round(angle):
    drag, v = (0.09, 0.09, 0.36), (2.0 * math.cos(angle), 2.0 * math.sin(angle), 0.0)
    force = axis_by_axis(drag, v) + missing((1.0, 0.0, *drag), v)[:3]
    np.testing.assert_allclose(force, -0.09 * 2.0 * np.array(v), atol=1e-15)


@given(v=vectors)
def test_both_shares_make_the_drag_go_with_the_speed(v):
    drag = (0.09, 0.07, 0.36)
    force = axis_by_axis(drag, v) + missing((1.0, 1.0, *drag), v)[:3]
    expected = -np.linalg.norm(v) * np.array(drag) * v
    np.testing.assert_allclose(force, expected, atol=1e-14)


def lifting(v, lift, stall):
    return np.array(OBLIQUE_LIFT.wrench((lift, stall), (), flown(tuple(v)), REST))


@given(v=vectors, lift=share, stall=st.floats(0.0, 10.0))
def test_oblique_lift_only_slows(v, lift, stall):
    assert np.dot(lifting(v, lift, stall)[:3], v) <= 0.0


@pytest.mark.parametrize(
    ('incidence', 'force'),
    # 0.6 N s2/m2 and a stall of 4 at 2 m/s; sin 0.173648 and 0.866025, cos 0.984808 and 0.5
    [(10.0, 2.4 * 0.171010 / 1.120615), (60.0, 2.4 * 0.433013 / 4.0)],
)
@pytest.mark.parametrize('heading', [0.0, 1.0, math.pi])
def test_a_round_hull_lifts_alike_in_every_heading(incidence, force, heading):
    up, level = 2.0 * math.sin(math.radians(incidence)), 2.0 * math.cos(math.radians(incidence))
    # The nose is up: the hull moves down in its own axes
    wrench = lifting((level * math.cos(heading), level * math.sin(heading), -up), 0.6, 4.0)
    np.testing.assert_allclose(wrench, [0.0, 0.0, force, 0.0, 0.0, 0.0], rtol=1e-5)


@given(v=vectors)
def test_a_lost_share_of_one_takes_the_munk_moment_away(v):
    momentum = tuple(a * x for a, x in zip(ADDED_MASS, v, strict=True))
    munk = np.array([-x for x in cross_product(v, momentum)])
    wrench = too_much(1.0, v)
    np.testing.assert_allclose(wrench, [0.0, 0.0, 0.0, *-munk], atol=1e-15)
    assert np.linalg.norm(munk) <= 0.5 * (0.2 - 0.05) * np.dot(v, v) * (1.0 + 1e-12)


# RGBlimp as its authors publish it (zhu-yj/ABNODE@138a1de).
RGBLIMP = {
    'density': 1.2187, 'area': 0.25,
    'drag': 0.2425, 'drag_alpha2': 4.4195, 'drag_beta2': 7.508,
    'side': 0.0083, 'side_alpha2': -0.0744, 'side_beta': -2.114,
    'lift': 0.1594, 'lift_alpha': 2.9375, 'lift_beta2': 4.5537,
    'roll': 0.0131, 'roll_alpha': -0.0301, 'roll_beta': -0.5256,
    'pitch': 0.0568, 'pitch_alpha': 0.0933, 'pitch_beta4': 5.2357,
    'yaw': 0.0006, 'yaw_alpha': -0.0012, 'yaw_beta': -0.0936,
    'roll_rate': 0.0503, 'pitch_rate': 0.0264, 'yaw_rate': 0.0137,
    'x': 0.0, 'z': 0.0,
}  # fmt: skip
P = tuple(RGBLIMP[parameter.name] for parameter in HULL_LIFT.parameters)


def published(v, w):
    """Return force and moment in axes forward, right, down, as the authors write it."""
    speed = np.linalg.norm(v)
    alpha, beta = np.arctan2(v[2], v[0]), np.arcsin(v[1] / speed)
    q = 0.5 * 1.2187 * speed**2 * 0.25
    drag = q * (0.2425 + 4.4195 * alpha**2 + 7.508 * beta**2)
    side = q * (0.0083 - 0.0744 * alpha**2 - 2.114 * beta)
    lift = q * (0.1594 + 2.9375 * alpha + 4.5537 * beta**2)
    moment = (
        q * (0.0131 - 0.0301 * alpha - 0.5256 * beta) - 0.0503 * w[0],
        q * (0.0568 + 0.0933 * alpha + 5.2357 * beta**4) - 0.0264 * w[1],
        q * (0.0006 - 0.0012 * alpha - 0.0936 * beta) - 0.0137 * w[2],
    )
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    to_body = np.array([[ca * cb, -ca * sb, -sa], [sb, cb, 0.0], [sa * cb, -sa * sb, ca]])
    return to_body @ (-drag, side, -lift), to_body @ moment


FLIP = np.array([1.0, -1.0, -1.0])  # left and up to right and down, vectors and rates alike


def lifted(v, w=NO):
    return np.array(HULL_LIFT.wrench(P, (), flown(tuple(v), tuple(w)), REST))


@pytest.mark.parametrize('seed', range(12))
def test_hull_lift_is_the_published_law_in_its_own_axes(seed):
    generator = np.random.default_rng(seed)
    speed = generator.uniform(0.3, 1.5)
    alpha, beta = generator.uniform(-0.6, 0.6), generator.uniform(-0.5, 0.5)
    v = speed * np.array(
        [np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)]
    )
    w = generator.uniform(-1.0, 1.0, 3)
    force, moment = published(v, w)
    wrench = lifted((FLIP * v).tolist(), (FLIP * w).tolist())
    # The angles differ by (1 mm/s / v_x)^2 / 2, and v_x is at least 0.72 of the speed.
    bound = 2e-6 / speed**2
    assert np.linalg.norm(FLIP * wrench[:3] - force) <= bound * np.linalg.norm(force)
    assert np.linalg.norm(FLIP * wrench[3:] - moment) <= bound * (
        np.linalg.norm(moment) + 0.05 * np.linalg.norm(w)
    )


@given(v=vectors, w=vectors, way=vectors)
def test_hull_lift_has_no_step(v, w, way):
    """Anywhere, backwards and in pure side-slip as well, within a thousandth of SLOW."""
    step = 1e-6
    near = np.array(v) + step * np.array(way)
    change = lifted(near.tolist(), w) - lifted(v, w)
    # Forces to 200 N at 5 m/s turn round within SLOW, twice.
    assert np.all(abs(change) <= np.linalg.norm(way) * step / SMALL_SPEED * 400.0)


@given(v=vectors, w=vectors)
def test_hull_lift_damping_never_drives(v, w):
    """Any way it flies, backwards and broadside as well: RGBlimp's rates only lose by it."""
    damping = lifted(v, w)[3:] - lifted(v)[3:]
    assert np.dot(damping, w) <= 1e-12 * (1.0 + np.dot(v, v))


MIRROR = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])  # x backwards: forces, then moments


@given(v=vectors, w=vectors)
def test_hull_lift_backwards_is_the_law_of_the_mirror_image(v, w):
    back = lifted(MIRROR[:3] * v, MIRROR[3:] * w)
    np.testing.assert_allclose(back, MIRROR * lifted(v, w), rtol=1e-9, atol=1e-9)
