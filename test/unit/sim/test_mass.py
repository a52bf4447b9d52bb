"""Mass matrices against Lamb's limits, a numerical integral and a body of point masses."""

import math

from lta_model.mass_properties import build_part_element, rigid_mass_matrix, spheroid_added_mass
from lta_model.vehicle import load_vehicle
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
    # Of the whole vehicle's yaw inertia, 28.4 g m2, the difference is below a hundredth
    assert gtmab.inertia[2, 2] == pytest.approx(0.0284, abs=1e-4)
    assert abs(own - exact) / gtmab.inertia[2, 2] < 0.01
