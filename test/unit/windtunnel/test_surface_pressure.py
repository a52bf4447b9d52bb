# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pressure on surfaces: potential flow against a sphere and panels, and what a flow leaves."""

import math

from lta_model.mass_properties import half_axes
from lta_model.vehicle import load_vehicle
from lta_windtunnel.analytic import added_mass_share, pressure_coefficient, pressure_extremes
from lta_windtunnel.flow_fields import read_surface_pressure, summarize_surface_pressure
import numpy as np
import pytest
import trimesh

HULL = load_vehicle('gtmab').file.hull


def spheroid(height):
    """Return a fine spheroid of radius 1 about z."""
    mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.apply_scale((1.0, 1.0, height))
    return mesh


def by_sources(places, normals, along):
    """Return the pressure coefficient on a surface, by point sources a little below it."""
    inside = places - 0.25 * normals
    apart = places[:, None] - inside[None]
    field = apart / np.linalg.norm(apart, axis=2, keepdims=True) ** 3
    stream = np.eye(3)[along]
    through = np.einsum('ijk,ik->ij', field, normals)
    strength = np.linalg.lstsq(through, -normals @ stream, rcond=None)[0]
    speed = stream + np.einsum('ijk,j->ik', field, strength)
    return 1.0 - (speed**2).sum(axis=1)


def test_a_sphere_has_the_pressure_of_the_books():
    angle = np.radians([0.0, 30.0, 90.0, 180.0])
    normals = np.stack((np.cos(angle), np.sin(angle), 0.0 * angle), axis=-1)
    assert pressure_coefficient(normals, 0, 0.5) == pytest.approx(1.0 - 2.25 * np.sin(angle) ** 2)


@pytest.mark.parametrize('along', [0, 2])
def test_a_spheroid_has_the_pressure_that_point_sources_find(along):
    half = np.array(half_axes(HULL))
    ball = trimesh.creation.icosphere(subdivisions=3).vertices
    places, normals = half * ball, ball / half
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    exact = pressure_coefficient(normals, along, added_mass_share(HULL, along))
    assert by_sources(2.0 * places, normals, along) == pytest.approx(exact, abs=0.005)


def test_pressure_alone_does_not_brake_a_spheroid():
    mesh = spheroid(0.6)
    pressure = pressure_coefficient(mesh.face_normals, 0, added_mass_share(HULL, 0))
    force = (pressure * mesh.area_faces) @ mesh.face_normals
    assert np.abs(force).max() < 1e-12 + 1e-3 * mesh.area


def test_the_nose_of_a_hull_feels_the_dynamic_pressure_and_its_sides_suction():
    low, high = pressure_extremes(HULL, 0, 2.0, 1.2)
    assert high == pytest.approx(2.4)
    assert low == pytest.approx(2.4 * (1.0 - (1.0 + added_mass_share(HULL, 0)) ** 2))
    assert low < 0.0


def test_what_is_kept_is_the_extremes_and_what_is_seen_from_below():
    mesh = spheroid(0.6)
    places = mesh.triangles_center
    kept = summarize_surface_pressure(places, places[:, 1] * 10.0)
    top = float(places[:, 1].max())
    assert (kept.least, kept.most) == (
        pytest.approx(-10 * top, rel=1e-2),
        pytest.approx(10 * top, rel=1e-2),
    )
    assert kept.most_at[1] > 0.9
    rows = kept.below
    assert rows[0][0] is None  # a corner, beside the disc
    middle = len(rows) // 2
    assert rows[3][middle] < 0.0 < rows[-4][middle]


def test_the_newest_pressure_is_read_in_pascals(tmp_path):
    for time, first in (('100', 7.0), ('300', -2.0)):
        place = tmp_path / 'postProcessing' / 'pressure' / time
        place.mkdir(parents=True)
        rows = [(0, 0, -1, first), (1, 0, -1, 3), (0, 1, -1, 0), (-1, 0, -1, 0), (0, -1, 0, 0)]
        lines = '\n'.join(' '.join(map(str, row)) for row in rows)
        (place / 'p_hull.raw').write_text(f'# p  FACE_DATA 5\n# x  y  z  p\n{lines}\n')
    found = read_surface_pressure(tmp_path, 'hull', 1.2)
    assert (found.least, found.most) == (-2.4, 3.6)
    assert found.most_at == [1.0, 0.0, -1.0]
    assert math.isclose(found.side, 2.0)
