# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Mass matrices against Lamb's limits, a numerical integral and a body of point masses."""

import math

from lta_model.mass_properties import (
    build_gas_element,
    build_part_element,
    frozen_gas_inertia,
    rigid_mass_matrix,
    spheroid_added_mass,
)
from lta_model.state import INERTIA
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.integrate import quad

RHO = 1.2


def displaced(radius, half_axis):
    return RHO * 4.0 / 3.0 * math.pi * radius**2 * half_axis


@pytest.mark.parametrize(
    'ratio', [0.2, 0.35, 0.5992, 0.9, 0.97, 0.999, 1.001, 1.03, 1.2, 2.1, 3.5, 5.0, 6.0]
)
def test_against_the_integral(ratio):
    a, c = 0.5, 0.5 * ratio

    def integrand(s, axis):
        return a * a * c * 2.0 * s / ((axis**2 + s * s) * (a**2 + s * s) * math.hypot(c, s))

    def integral(axis):
        limits = {'epsabs': 1e-13, 'epsrel': 1e-13, 'limit': 500}
        return quad(integrand, 0.0, math.inf, args=(axis,), **limits)[0]

    across, along = integral(a), integral(c)
    m = displaced(a, c)
    inertia = m / 5.0 * (a**2 - c**2) ** 2 * (along - across)
    inertia /= 2.0 * (a**2 - c**2) + (a**2 + c**2) * (across - along)
    added = spheroid_added_mass(a, c, RHO)
    lateral, axial = across / (2.0 - across) * m, along / (2.0 - along) * m
    np.testing.assert_allclose(added[:3], (lateral, lateral, axial), rtol=1e-9)
    np.testing.assert_allclose(added[3:], (inertia, inertia, 0.0), rtol=1e-6)


def test_axis_of_symmetry():
    across, _, along, spin, _, _ = spheroid_added_mass(0.3, 0.8, RHO, 'z')
    expected = (across, along, across, spin, 0.0, spin)
    assert spheroid_added_mass(0.3, 0.8, RHO, 'y') == expected


def test_rigid_body_is_the_sum_of_its_points():
    generator = np.random.default_rng(1)
    masses, places = generator.uniform(0.1, 1.0, 20), generator.normal(size=(20, 3))
    mass = masses.sum()
    cg = masses @ places / mass
    inertia = sum(
        m * ((r - cg) @ (r - cg) * np.eye(3) - np.outer(r - cg, r - cg))
        for m, r in zip(masses, places, strict=True)
    )
    nu = generator.normal(size=6)
    speeds = nu[:3] + np.cross(nu[3:], places)
    kinetic = 0.5 * masses @ (speeds**2).sum(axis=1)
    matrix = rigid_mass_matrix(mass, cg, inertia)
    assert 0.5 * nu @ matrix @ nu == pytest.approx(kinetic, rel=1e-13)
    np.testing.assert_array_equal(matrix, matrix.T)


def test_the_film_of_a_foil_balloon_is_nearly_a_shell_between_similar_ellipsoids():
    """
    Two flat discs, welded at the edge and filled: the mylar balloon (Paulsen 1994).

    A ring of the flat disc at arc length s comes to lie at the radius r(s), ds/dr = 1 / sqrt(1 -
    r^4) with the inflated radius 1. It keeps its mass, 2 pi s ds by area: the wrinkles carry more
    foil outwards than an even skin (0.618 m a^2 for a spheroid of 0.599) has there.
    """

    def arc(r):
        return quad(lambda t: 1.0 / math.sqrt(1.0 - t**4), 0.0, r)[0]

    edge = arc(1.0)
    assert edge == pytest.approx(1.31103, abs=1e-5)  # half of the lemniscate constant
    film = quad(lambda r: r**2 * arc(r) / math.sqrt(1.0 - r**4), 0.0, 1.0)[0] * 2.0 / edge**2
    assert film == pytest.approx(0.6586, abs=1e-4)
    gtmab = load_vehicle('gtmab')
    envelope = gtmab.file.layers['hull']['envelope']
    own = build_part_element(envelope).inertia[2]
    mass = envelope.mass.si
    assert own == pytest.approx(mass * 0.5**2 * 2.0 / 3.0)  # 19.5 g m2
    exact = mass * 0.5**2 * film
    assert own / exact == pytest.approx(1.0, abs=0.015)
    # Of the whole vehicle's yaw inertia, 20.2 g m2, the difference is little more than a hundredth
    assert gtmab.inertia[2, 2] == pytest.approx(0.0202, abs=1e-4)
    assert abs(own - exact) / gtmab.inertia[2, 2] < 0.0125


@pytest.mark.parametrize('axes', [(0.5, 0.5, 0.3), (0.9, 0.3, 0.3), (0.4, 0.4, 0.4)])
def test_gas_in_a_turning_ellipsoid_has_the_energy_of_its_potential_flow(axes):
    """
    Turning about x with 1 rad/s, the potential is s y z, s = (b^2 - c^2) / (b^2 + c^2).

    On the surface its gradient (0, s z, s y) must have the normal component of the wall's velocity
    (0, -z, y), and its energy is that of the inertia. Drawn at random in the ellipsoid.
    """
    fluid = build_gas_element(0.08, axes).inertia
    frozen = frozen_gas_inertia(0.08, axes)
    on = np.random.default_rng(3).normal(size=(40_000, 3))
    on *= np.array(axes) / np.linalg.norm(on, axis=1)[:, None]
    inside = on * np.random.default_rng(4).random((len(on), 1)) ** (1.0 / 3.0)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        b, c = axes[i] ** 2, axes[j] ** 2
        s = (b - c) / (b + c)
        wall = -on[:, j] * on[:, i] / b + on[:, i] * on[:, j] / c
        flow = s * (on[:, j] * on[:, i] / b + on[:, i] * on[:, j] / c)
        np.testing.assert_allclose(flow, wall, atol=1e-12)
        squares = (inside[:, i] ** 2 + inside[:, j] ** 2).mean()
        assert fluid[k] == pytest.approx(0.08 * s**2 * squares, rel=0.02, abs=1e-12)
        assert fluid[k] + frozen[k] == pytest.approx(0.08 * (b + c) / 5.0, rel=1e-12)


def test_a_share_of_the_gas_turns_with_the_hull():
    # 82 g in half axes of 0.5 and 0.2995 m: 4.33 and 8.20 g m2 are frozen in a rigid gas
    gtmab = load_vehicle('gtmab')
    share = gtmab.file.effects['gas_rotation']['share'].si
    model = gtmab.build_model()
    about_hull = gtmab.inertia + gtmab.mass * (
        gtmab.cg @ gtmab.cg * np.eye(3) - np.outer(gtmab.cg, gtmab.cg)
    )
    turning = np.array(model.body[INERTIA : INERTIA + 3]) - about_hull.diagonal()
    np.testing.assert_allclose(1e3 * turning / share, (4.333, 4.333, 8.204), atol=1e-3)
    # The boundary layer of helium at a period of 4 s is 12.2 mm; all of its drag is 3.7 d / r
    layer = math.sqrt(2.0 * 1.96e-5 / 0.1664 * 4.0 / (2.0 * math.pi))
    assert share == pytest.approx(3.7 * layer / 0.5, abs=0.002)
