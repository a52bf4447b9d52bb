"""Mass matrices against Lamb's limits, a numerical integral and a body of point masses."""

import math

from lta_model.mass_matrix import rigid_mass_matrix, spheroid_added_mass
import numpy as np
import pytest
from scipy.integrate import quad

RHO = 1.2


def displaced(radius, half_axis):
    return RHO * 4.0 / 3.0 * math.pi * radius**2 * half_axis


def test_sphere():
    added = spheroid_added_mass(0.4, 0.4, RHO)
    np.testing.assert_allclose(added[:3], 0.5 * displaced(0.4, 0.4), rtol=1e-14)
    assert added[3:] == (0.0, 0.0, 0.0)


def test_oblate_hull_of_a_foil_balloon():
    added = np.array(spheroid_added_mass(0.5, 0.2996, RHO))
    k = added[:3] / displaced(0.5, 0.2996)
    np.testing.assert_allclose(k, (0.355, 0.355, 0.909), atol=5e-4)


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


def test_disk():
    a = 0.5
    added = spheroid_added_mass(a, 1e-7, RHO)
    assert added[2] == pytest.approx(8.0 / 3.0 * RHO * a**3, rel=1e-5)
    assert added[3] == pytest.approx(16.0 / 45.0 * RHO * a**5, rel=1e-5)


def test_needle():
    added = np.array(spheroid_added_mass(0.01, 10.0, RHO, 'x'))
    m = displaced(0.01, 10.0)
    assert added[0] / m == pytest.approx(0.0, abs=1e-5)
    np.testing.assert_allclose(added[1:3] / m, 1.0, rtol=2e-5)
    np.testing.assert_allclose(added[4:] / m, 10.0**2 / 5.0, rtol=1e-4)


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
