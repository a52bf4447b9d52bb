# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Shapes that stand in the tunnel, and the hull that the design loop finds."""

import math
from pathlib import Path
import runpy
import sys

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.schema.mount_file import load_mount
from lta_model.vehicle import load_vehicle
from lta_windtunnel.analytic import drag_force
from lta_windtunnel.shape import (
    build_hull_surface,
    ellipse_profile,
    mylar_profile,
    read_stl,
    revolve_profile,
)
from lta_windtunnel.tunnel_model import build_box_surface, load_tunnel_model, winding_number
import numpy as np
import pytest

AIR = (1.2, 1.5e-5)
BALLOON = revolve_profile(mylar_profile(), 0.5, 2 * 0.59907 * 0.5)


def test_a_mylar_balloon_is_paulsens():
    # Paulsen 1994: height 0.599 R, volume 2.7458 R^3, area pi^2 R^2 (2.467 m2 at 0.5 m).
    assert mylar_profile()[0, 1] == pytest.approx(0.59907, rel=1e-4)
    assert BALLOON.volume == pytest.approx(2.7458 * 0.125, rel=2e-3)
    assert BALLOON.area == pytest.approx(np.pi**2 * 0.25, rel=2e-3)
    assert BALLOON.is_watertight


def test_a_flatter_balloon_holds_as_much_less():
    half = revolve_profile(mylar_profile(), 0.5, 0.59907 * 0.5)
    assert half.volume == pytest.approx(0.5 * BALLOON.volume)


def test_a_sphere_is_round():
    ball = revolve_profile(ellipse_profile(), 0.5, 1.0)
    assert ball.volume == pytest.approx(np.pi / 6, rel=2e-3)
    assert ball.area == pytest.approx(np.pi, rel=2e-3)


def test_a_spheroid_lies_along_its_axis():
    hull = load_vehicle('blimp2b').file.hull
    assert build_hull_surface(hull).extents == pytest.approx([1.092, 0.52, 0.52], rel=1e-3)


def test_no_hull_is_refused():
    with pytest.raises(BadInput, match='no hull'):
        build_hull_surface(load_vehicle('multirotor').file.hull)


def test_the_shipped_gtmab_is_what_was_meshed():
    model = load_tunnel_model('gtmab')
    assert model.frontal_area(0) == pytest.approx(0.500, rel=1e-2)
    assert model.frontal_area(2) == pytest.approx(0.785, rel=1e-2)
    assert model.is_mirror_symmetric(0)
    assert model.is_mirror_symmetric(1)
    assert not model.is_mirror_symmetric(2)
    assert len(model.find_symmetries()) == 4  # the frame lies across, so no quarter turns
    assert len(load_tunnel_model('beavis').find_symmetries()) == 8


def test_winding_tells_inside_from_outside():
    points = np.array([[0.0, 0.0, 0.0], [0.49, 0.0, 0.0], [0.51, 0.0, 0.0], [0.0, 0.0, 2.0]])
    assert winding_number(BALLOON.triangles, points) == pytest.approx([1, 1, 0, 0], abs=1e-6)


def kept(mesh, folder):
    path = folder / 'part.stl'
    path.write_bytes(mesh.export(file_type='stl'))
    return path


def test_a_drawn_part_comes_in_metres(tmp_path):
    big = build_box_surface((0, 0, 0), (100, 50, 20))
    read = read_stl(kept(big, tmp_path), 'mm')
    assert read.extents == pytest.approx([0.1, 0.05, 0.02])
    assert read.volume == pytest.approx(1e-4)


def test_millimetres_for_metres_are_named(tmp_path):
    with pytest.raises(BadInput, match=r'100 m long if its unit is m, .*set "unit: mm"'):
        read_stl(kept(build_box_surface((0, 0, 0), (100, 50, 20)), tmp_path), 'm')


def test_an_open_surface_is_refused_with_its_edges(tmp_path):
    mesh = build_box_surface((0, 0, 0), (0.1, 0.1, 0.1))
    mesh.update_faces(np.arange(len(mesh.faces)) > 0)
    with pytest.raises(BadInput, match='3 edges do not join'):
        read_stl(kept(mesh, tmp_path), 'm')


def test_rubbish_is_no_stl(tmp_path):
    path = tmp_path / 'part.stl'
    path.write_bytes(b'solid nothing at all')
    with pytest.raises(BadInput, match='export it again'):
        read_stl(path, 'm')


TUNNEL = """
schema: 1
name: wrong
about: a test
vehicle: gtmab
disk:
  diameter: {{value: 47, unit: mm, source: test}}
  thickness: {{value: 16, unit: mm, source: test}}
{more}
"""


def tunnel(folder, more):
    path = folder / 'wrong.yaml'
    path.write_text(TUNNEL.format(more=more))
    return str(path)


def test_a_rotor_in_a_body_is_refused(tmp_path):
    more = (
        'bodies: {block: {position: {value: [0, 19, -34], unit: cm, source: test}, '
        'size: {value: [10, 10, 10], unit: cm, source: test}}}'
    )
    with pytest.raises(BadInput, match=r'rotor up_left .* is inside the body block'):
        load_tunnel_model(tunnel(tmp_path, more))


def test_a_vehicle_file_is_told_from_a_tunnel_file(tmp_path):
    path = tmp_path / 'mine.yaml'
    path.write_text(find_file('vehicle', 'gtmab').read_text('utf-8'))
    with pytest.raises(BadInput, match='is a vehicle file, not a tunnel file; copy one of'):
        load_tunnel_model(str(path))


def test_a_pattern_of_strangers_is_refused(tmp_path):
    with pytest.raises(
        BadInput, match=r'names unknown rotors \(tail\); the rotors of gtmab are up_left'
    ):
        load_tunnel_model(tunnel(tmp_path, 'patterns: {all: {tail: 1}}'))


def test_a_body_is_a_box_or_a_file(tmp_path):
    with pytest.raises(BadInput, match='either "position" and "size" of a box, or "stl"'):
        load_tunnel_model(tunnel(tmp_path, 'bodies: {block: {stl: a.stl}}'))


@pytest.mark.parametrize(('mount', 'parts'), [('side', 2), ('bottom', 4), ('top', 2)])
def test_solar_panels_stand_in_the_tunnel_where_a_mount_file_has_them(mount, parts):
    bare, model = load_tunnel_model('gtmab'), load_tunnel_model('gtmab', load_mount(mount))
    added = model.bodies.keys() - bare.bodies.keys()
    assert len(added) == parts
    assert model.is_mirror_symmetric(1)
    assert (model.name, model.fingerprint != bare.fingerprint) == (f'gtmab_{mount}', True)
    for axis in range(3):  # by hand panels and arms brake as plates
        shadow = sum(float(np.prod(np.delete(model.bodies[p].extents, axis))) for p in added)
        more = drag_force(model, axis, 1.0, AIR) - drag_force(bare, axis, 1.0, AIR)
        assert more == pytest.approx(0.6 * 1.17 * shadow)


EXAMPLE = Path(__file__).resolve().parents[3] / 'examples/hull_shapes.py'


def test_the_design_loop_finds_what_carries_most_for_its_drag(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, 'argv', [str(EXAMPLE)])
    runpy.run_path(str(EXAMPLE), run_name='__main__')
    _, *rows, _ = capsys.readouterr().out.splitlines()
    found = {(row.split()[0], float(row.split()[1])): row.split()[2:] for row in rows}
    assert len(found) == 18
    carried, braked, *_ = found['sphere', 1.0]
    # 0.93 (1.2041 - 0.1664) pi / 6 m3, less 0.047 kg/m2 on pi m2.
    assert float(carried) == pytest.approx(505.3 - 147.7, abs=2.0)
    friction = 1.328 / math.sqrt(0.5 / 1.5e-5)
    assert float(braked) == pytest.approx(
        1e3 * 0.6 * 0.25 * math.pi / 4 * (0.44 + 8.0 * friction), rel=0.01
    )
    assert [name for name, row in found.items() if '*' in row] == [
        ('sphere', 1.1), *((('cigar', size)) for size in (0.6, 0.7, 0.8, 0.9, 1.0, 1.1))
    ]  # fmt: skip
    assert (tmp_path / 'hull_shapes.html').is_file()
