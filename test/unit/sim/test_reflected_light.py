# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Reflections, shade, daylight and a door against sums over patches and rays, and by hand."""

from dataclasses import replace
import math

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_config.compilation.compiler import compile_functions
from lta_model.light.direct_light import build_beam, DiodeResponse, visible_fraction
from lta_model.light.field import (
    Albedo,
    Ambient,
    Daylight,
    LightField,
    OutdoorArea,
    Room,
)
from lta_model.light.lamp import BeaconLamp, direct_illuminance, SquareWave
from lta_model.light.readings import write_pose_readings
from lta_model.light.reflected_light import (
    DAYLIGHT_ROW,
    gather_indirect_light,
    LAMP_ROWS,
    LIGHT_ROW,
    RING_BUNDLES,
    RINGS,
    scratch_size,
    trace_ring,
    UNIFORM_ROW,
    write_azimuths,
)
from lta_model.light.scene_geometry import (
    build_scene_geometry,
    daylight_illuminance,
    find_first_hit,
    is_path_clear,
)
from lta_model.light.view import (
    build_field_geometry,
    build_reflecting_beam,
    integrate_reflected_flux,
    pack_beams,
)
from lta_model.sensors.photodiode import PhotodiodeArray
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .even_light import spread_evenly

LED = 300.0
SIZE = (10.0, 8.0, 3.0)
ROOM = Room(SIZE, Albedo(0.3, 0.5, 0.7))
LAMP = BeaconLamp((3.5, 0.0, 1.0), (-1.0, 0.0, 0.0), 10_000.0, SquareWave(150.0), LED)
RING = PhotodiodeArray(count=8, depth=0.33, radius=0.07, feedback_resistance=1e5)
HULL = (0.5, 0.5, 0.3)
NO_HULL = (0.0, 0.0, 0.0)
EYE, FLAT = DiodeResponse(1.2, 0.0), DiodeResponse(1.0, 0.0)
DARK = Ambient(LED)
DAYLIGHT = Daylight(90_000.0, math.radians(30.0), math.radians(45.0), 15_000.0, 0.2, 105.0)
OUTSIDE = OutdoorArea(DAYLIGHT, 1.0, 2.0, 2.2)
# As the simulator has them, which has compiled them before the tests.
(GATHER, ON_THE_WAY), (ON_FACES,) = (
    compile_functions(gather_indirect_light, write_pose_readings),
    compile_functions(integrate_reflected_flux),
)


def gathered(field, position, q=(0.0, 0.0, 0.0, 1.0), eye=EYE, hull=HULL, ring=RING):
    out = np.empty((LAMP_ROWS + len(field.lamps), ring.count))
    scratch = np.empty(scratch_size(len(field.lamps)))
    GATHER(
        build_field_geometry(field),
        pack_beams(field),
        eye,
        hull,
        position,
        q,
        ring.planes,
        out,
        scratch,
    )
    return out


def hidden(points, directions, hull):
    """Tell which rays meet the ellipsoid, by the quadratic they solve; both (..., 3), body."""
    p, u = points / np.array(hull), directions / np.array(hull)
    a, b, c = (u * u).sum(-1), (p * u).sum(-1), (p * p).sum(-1) - 1.0
    return (b < 0.0) & (b * b > a * c)


def patches(room, pitch):
    """Return centres, normals, areas and albedos of small squares on all faces."""
    length, width, height = room.size
    found = []
    faces = [
        ((0, 1), 2, 0.0, 1.0, room.albedo.floor),
        ((0, 1), 2, height, -1.0, room.albedo.ceiling),
        ((1, 2), 0, length / 2, -1.0, room.albedo.walls),
        ((1, 2), 0, -length / 2, 1.0, room.albedo.walls),
        ((0, 2), 1, width / 2, -1.0, room.albedo.walls),
        ((0, 2), 1, -width / 2, 1.0, room.albedo.walls),
    ]
    for (a, b), axis, level, normal, albedo in faces:
        low = np.array([-length / 2, -width / 2, 0.0])
        counts = [round(room.size[k] / pitch) for k in (a, b)]
        grids = [
            low[k] + (np.arange(n) + 0.5) * room.size[k] / n
            for k, n in zip((a, b), counts, strict=True)
        ]
        across, up = np.meshgrid(*grids, indexing='ij')
        centres, normals = np.zeros((across.size, 3)), np.zeros((across.size, 3))
        centres[:, a], centres[:, b], centres[:, axis] = across.ravel(), up.ravel(), level
        normals[:, axis] = normal
        area = room.size[a] * room.size[b] / across.size
        found.append((centres, normals, np.full(across.size, area), np.full(across.size, albedo)))
    return (np.concatenate(part) for part in zip(*found, strict=True))


def first_echo(room, position, turn, eye, hull, ring=RING, pitch=0.04):
    """Return what diodes read of light thrown back once: a sum over small patches."""
    centres, normals, areas, albedos = patches(room, pitch)
    lux = direct_illuminance(LAMP, centres, normals)
    told = []
    for row in ring.planes:
        ray = centres - (position + turn @ row[:3])
        distance = np.linalg.norm(ray, axis=1)
        u = ray / distance[:, None]
        leaving = np.maximum(-(u * normals).sum(1), 0.0)
        cosine = np.maximum(u @ (turn @ row[3:]), 0.0)
        open_ = ~hidden(row[:3], u @ turn, hull) if hull[0] else np.ones(len(u), dtype=bool)
        bright = albedos * lux / math.pi * areas * leaving / distance**2
        told.append((bright * cosine**eye.exponent * open_).sum())
    return np.array(told)


def poses(count):
    rng = np.random.default_rng(5)
    for _ in range(count):
        place = rng.uniform((-4.0, -3.0, 0.8), (2.0, 3.0, 1.6))
        turn = Rotation.from_euler('zyx', rng.uniform((-3.1, -0.1, -0.1), (3.1, 0.1, 0.1)))
        yield place, turn


@pytest.mark.parametrize('hull', [HULL, NO_HULL])
def test_echo_by_place_is_the_sum_over_patches(hull):
    """Within 3 % of the mean echo of a ring and 6 % on each diode, tilted and turned."""
    field = LightField((LAMP,), DARK, ROOM)
    for place, turn in poses(4):
        out = gathered(field, tuple(place), tuple(turn.as_quat()), hull=hull)
        own = out[LAMP_ROWS] - build_reflecting_beam(LAMP, field).beyond * out[UNIFORM_ROW]
        expected = first_echo(ROOM, place, turn.as_matrix(), EYE, hull)
        assert own.mean() == pytest.approx(expected.mean(), rel=0.03)
        assert np.abs(own - expected).max() < 0.06 * expected.mean()


@pytest.mark.parametrize('order', [1.0, 1.7])
@pytest.mark.parametrize('place', [(3.5, 0.0, 1.0), (-5.0, 1.0, 2.0), (0.0, 0.0, 3.0)])
def test_several_pencils_at_once_bring_what_each_does_alone(order, place):
    """A room with a door that nothing fits through is looked at ray by ray."""
    lamp = build_beam(replace(LAMP, position=place, axis=(-0.3, 0.5, -0.8), order=order))
    closed = build_scene_geometry(ROOM, None, None)
    for point in ((0.0, 0.0, 1.0), (-4.9, 3.9, 0.01), (7.0, 0.0, 1.0)):
        told = []
        for s in (closed, closed._replace(top=1e-9)):
            scratch = np.zeros(scratch_size(1))
            write_azimuths(scratch)
            rows = []
            for ring in RINGS:
                trace_ring(s, (lamp,), point, ring, scratch)
                rows.append(scratch[LIGHT_ROW + RING_BUNDLES * LAMP_ROWS :].copy())
            told.append(np.array(rows))
        assert told[0].any() == (point[0] < 5.0)
        np.testing.assert_allclose(told[0], told[1], rtol=1e-9, atol=1e-12)


def test_light_from_all_sides_by_quadrature():
    """2 / (n + 1) (1 - c^(n + 1)) of it, without a hull."""
    field = LightField((LAMP,), DARK, ROOM)
    for eye in (DiodeResponse(1.0, 0.0), EYE, DiodeResponse(2.0, 0.5)):
        share = gathered(field, (0.0, 0.0, 1.0), eye=eye, hull=NO_HULL)[UNIFORM_ROW]
        whole = 2.0 / (eye.exponent + 1.0) * (1.0 - eye.least ** (eye.exponent + 1.0))
        assert share.mean() == pytest.approx(whole, rel=0.01)
        assert np.ptp(share) < 0.02 * whole


def test_the_hull_hides_what_rays_meet():
    """The share of light from all sides under a hull, by rays spread evenly over the sphere."""
    k = np.arange(40_000) + 0.5
    up, turn = 1.0 - 2.0 * k / k.size, k * math.pi * (3.0 - math.sqrt(5.0))
    level = np.sqrt(1.0 - up * up)
    u = np.stack([level * np.cos(turn), level * np.sin(turn), up], axis=1)
    share = gathered(LightField((LAMP,), DARK, ROOM), (0.0, 0.0, 1.0))[UNIFORM_ROW]
    for own, row in zip(share, RING.planes, strict=True):
        cosine = np.maximum(u @ row[3:], 0.0) ** EYE.exponent
        expected = 4.0 * (cosine * ~hidden(row[:3], u, HULL)).mean()
        assert own == pytest.approx(expected, rel=0.02)


def test_shade_of_a_ball_by_hand():
    """From 2 radii under a ball its edge is 30 degrees off the vertical."""
    ball, point = (0.4, 0.4, 0.4), (0.0, 0.0, -0.8)
    for off, expected in ((29.0, 0.0), (29.9, 0.45), (30.0, 0.5), (30.1, 0.55), (31.0, 1.0)):
        angle = math.radians(off)
        towards = (math.sin(angle), 0.0, math.cos(angle))
        part = visible_fraction(ball, point, towards, math.radians(1.0))
        assert part == pytest.approx(expected, abs=6e-3)  # the edge to first order
    assert visible_fraction(ball, point, (0.0, 0.0, 1.0), 1e-3) == 0.0
    assert visible_fraction(ball, point, (0.0, 0.0, -1.0), 1e-3) == 1.0
    assert visible_fraction((0.0, 0.0, 0.0), point, (0.0, 0.0, 1.0), 1e-3) == 1.0


UNIT = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: math.hypot(*v) > 0.1)


@settings(max_examples=200)
@given(point=UNIT, towards=UNIT, width=st.floats(1e-4, 0.2))
def test_shade_is_that_of_the_ray_apart_from_its_edge(point, towards, width):
    p, u = np.array(point), np.array(towards) / math.hypot(*towards)
    p = p * (1.2 / np.linalg.norm(p / np.array(HULL)))  # a fifth outside
    part = visible_fraction(HULL, tuple(p), tuple(u), width)
    assert 0.0 <= part <= 1.0
    if part in (0.0, 1.0):
        return
    # At the edge: turned by somewhat more than the width both ways it is dark and bright.
    axis = np.cross(u, p)
    turned = [
        Rotation.from_rotvec(axis / np.linalg.norm(axis) * 4.0 * k * width).apply(u)
        for k in (-1.0, 1.0)
    ]
    seen = [bool(hidden(p, v, HULL)) for v in turned]
    assert sorted(seen) == [False, True]


@pytest.mark.parametrize('place', [(3.5, 0.0, 1.0), (-2.0, 3.0, 2.9), (4.9, -3.9, 0.1)])
def test_all_the_light_falls_on_the_faces(place):
    """Direct flux on six faces is the lamp's, to what the grid leaves out."""
    lamp = BeaconLamp(place, (-1.0, 0.2, -0.3), 10_000.0, SquareWave(150.0), LED)
    fallen, _ = ON_FACES(build_scene_geometry(ROOM, None, None), build_beam(lamp), 256)
    assert fallen == pytest.approx(10_000.0, rel=0.02)


@settings(max_examples=25, deadline=None)
@given(
    albedo=st.tuples(*[st.floats(0.0, 0.95)] * 3),
    place=st.tuples(st.floats(-4.0, 4.0), st.floats(-3.0, 3.0), st.floats(0.5, 2.5)),
    axis=UNIT,
)
def test_energy_balances(albedo, place, axis):
    """What the surfaces swallow of direct, once and more often thrown back light is the flux."""
    room = Room(SIZE, Albedo(*albedo))
    lamp = BeaconLamp(place, axis, 10_000.0, SquareWave(150.0), LED)
    echo = build_reflecting_beam(lamp, LightField((lamp,), DARK, room))
    first = room.surface_area * echo.diffuse * (1.0 - room.mean_albedo)
    swallowed = (10_000.0 - first) + (1.0 - room.mean_albedo) * room.surface_area * echo.diffuse
    assert swallowed == pytest.approx(10_000.0, rel=1e-12)
    assert min(albedo) * 10_000.0 * (1 - 1e-9) <= first <= max(albedo) * 10_000.0 * (1 + 1e-9)


def test_even_walls_echo_as_sumpner_says():
    room = Room(SIZE, Albedo(0.5, 0.5, 0.5))
    echo = build_reflecting_beam(LAMP, LightField((LAMP,), DARK, room))
    # 268 m^2 of surface: 10 000 x 0.5 / (268 x 0.5)
    assert spread_evenly(10_000.0, room) == pytest.approx(37.3134, abs=1e-4)
    assert echo.diffuse == pytest.approx(37.3134, abs=1e-4)
    assert echo.beyond == pytest.approx(37.3134 / 2.0, abs=1e-4)


def test_echo_of_a_ring_averages_to_the_rooms():
    """Over places and directions in a bare room the once reflected light is rho Phi / A."""
    room = Room(SIZE, Albedo(0.5, 0.5, 0.5))
    field = LightField((LAMP,), DARK, room)
    centres, normals, areas, _ = patches(room, 1.0)
    axes = tuple(tuple(row) for row in np.eye(3).tolist() + (-np.eye(3)).tolist())
    ring = PhotodiodeArray(count=6, depth=0.0, radius=0.0, feedback_resistance=1e5, axes=axes)
    total = 0.0
    for centre, normal, area in zip(centres, normals, areas, strict=True):
        out = gathered(field, tuple(centre + 1e-3 * normal), eye=FLAT, hull=NO_HULL, ring=ring)
        facing = int(np.argmax(np.array(axes) @ normal))
        total += area * (out[LAMP_ROWS, facing] - 18.6567 * out[UNIFORM_ROW, facing])
    # Of 10 000 lm half goes on, and all of that arrives.
    assert total == pytest.approx(5000.0, rel=0.03)


def test_daylight_in_the_open_by_hand():
    """A plane in the open: the sun's cosine, the sky over and the ground under it."""
    s = build_scene_geometry(None, DAYLIGHT, None)
    level = 90_000.0 * math.sin(math.radians(45.0)) + 15_000.0
    assert DAYLIGHT.ground_illuminance == pytest.approx(level)
    assert daylight_illuminance(s, (0.0, 0.0, 1.0), (0.0, 0.0, 1.0)) == pytest.approx(level)
    away = (-math.cos(math.radians(30.0)), -math.sin(math.radians(30.0)), 0.0)
    assert daylight_illuminance(s, (0.0, 0.0, 1.0), away) == pytest.approx(7500.0 + 0.1 * level)
    ring = gathered(
        LightField((LAMP,), DARK, None, DAYLIGHT), (0.0, 0.0, 1.0), eye=FLAT, hull=NO_HULL
    )
    sun = 90_000.0 * math.cos(math.radians(45.0)) * math.cos(math.radians(30.0))
    assert ring[DAYLIGHT_ROW, 0] == pytest.approx(sun + 7500.0 + 0.1 * level, rel=5e-3)


def test_the_hull_hides_the_sun():
    field = LightField((LAMP,), DARK, None, DAYLIGHT)
    shaded, free = gathered(field, (0.0, 0.0, 1.0)), gathered(field, (0.0, 0.0, 1.0), hull=NO_HULL)
    assert free[DAYLIGHT_ROW].max() > 50_000.0
    # Under the hull the ground is left, a fifth of 78.6 klx on the lower half of a diode's view.
    assert 5000.0 < shaded[DAYLIGHT_ROW].max() < 12_000.0


BUILDING = build_scene_geometry(ROOM, None, OUTSIDE)


@pytest.mark.parametrize(
    ('begin', 'end', 'free'),
    [
        ((0.0, 1.0, 1.0), (9.0, 1.0, 1.0), True),
        ((0.0, 1.0, 1.0), (9.0, 1.0, 3.5), False),
        ((0.0, -1.0, 1.0), (9.0, -1.0, 1.0), False),
        ((0.0, -1.0, 1.0), (4.0, 3.0, 2.0), True),
        ((6.0, 1.0, 1.0), (9.0, -5.0, 2.0), True),
        ((9.0, 0.5, 0.5), (-4.0, 1.4, 1.5), True),
        ((9.0, 3.5, 1.0), (-9.0, 3.5, 1.0), False),
        ((9.0, 1.0, 1.0), (-9.0, 1.0, 1.0), False),
        ((0.0, 5.0, 1.0), (9.0, 5.0, 1.0), True),
    ],
)
def test_the_way_is_free_through_the_door_only(begin, end, free):
    ray = np.subtract(end, begin)
    distance = float(np.linalg.norm(ray))
    u = tuple((ray / distance).tolist())
    assert is_path_clear(BUILDING, begin, u, distance) is free
    back = tuple((-ray / distance).tolist())
    assert is_path_clear(BUILDING, end, back, distance) is free
    assert is_path_clear(build_scene_geometry(ROOM, None, None), begin, u, distance)


def test_what_a_ray_meets():
    met, indoors = find_first_hit(BUILDING, (0.0, 0.5, 1.0), (1.0, 0.0, 0.0))
    assert (indoors, met[:3]) == (False, (0.0, 0.0, 1e9))  # through the door, the sky
    met, indoors = find_first_hit(BUILDING, (0.0, -2.0, 1.0), (1.0, 0.0, 0.0))
    assert (indoors, met) == (True, (5.0, -2.0, 1.0, -1.0, 0.0, 0.0, 0.5))
    down = (math.cos(0.2), 0.0, -math.sin(0.2))
    met, indoors = find_first_hit(BUILDING, (4.0, 1.0, 1.0), down)
    assert (indoors, met.albedo) == (False, 0.2)  # the ground beyond the door
    assert met.x == pytest.approx(4.0 + 1.0 / math.tan(0.2))
    met, indoors = find_first_hit(BUILDING, (8.0, 1.0, 1.0), (-1.0, 0.0, 0.0))
    assert (indoors, met.x, met.albedo) == (True, -5.0, 0.5)
    met, indoors = find_first_hit(BUILDING, (8.0, -2.0, 1.0), (-1.0, 0.0, 0.0))
    assert (indoors, met.x, met.albedo) == (True, 5.0, 0.0)  # the wall from without


def test_daylight_comes_in_through_the_door():
    """Inside the door is a window: sky over the horizon and ground under it, through its area."""
    field = LightField((LAMP,), DARK, ROOM, None, OUTSIDE)
    day = gathered(field, (1.0, 1.0, 1.1 + RING.depth), eye=FLAT, hull=NO_HULL)[DAYLIGHT_ROW]
    y, z = np.meshgrid((np.arange(200) + 0.5) / 100.0 - 1.0, (np.arange(220) + 0.5) / 100.0 - 1.1)
    window = 3.93**2 / (3.93**2 + y * y + z * z) ** 2 / math.pi * 1e-4
    expected = (window * np.where(z > 0.0, 15_000.0, 0.2 * DAYLIGHT.ground_illuminance)).sum()
    # Rays are 7.5 degrees apart, the door is 27 degrees wide.
    assert day[0] == pytest.approx(expected, rel=0.13)
    assert day[4] == 0.0
    beyond = gathered(field, (8.0, 1.0, 1.4), eye=FLAT, hull=NO_HULL)[DAYLIGHT_ROW]
    assert beyond[0] > 50_000.0


def test_a_lamp_beyond_the_door_is_seen_through_it():
    lamp = BeaconLamp((9.0, 1.0, 1.0), (-1.0, 0.0, 0.0), 10_000.0, SquareWave(150.0), LED)
    field = LightField((lamp,), DARK, ROOM, None, OUTSIDE)
    none, lit = np.zeros((LAMP_ROWS + 1, 8)), np.empty((1, 2, 8))
    flight = np.array([[0.0, 1.0, 1.3, 0, 0, 0, 1], [0.0, -3.0, 1.3, 0, 0, 0, 1]], dtype=float)
    ON_THE_WAY(
        build_field_geometry(field), pack_beams(field), EYE, NO_HULL, flight, RING.planes,
        none, none, (0.0, 0.0, 0.0), lit, np.empty((2, 8)), np.empty((2, 8)),
    )  # fmt: skip
    assert lit[0, 0, 0] == pytest.approx(10_000.0 / math.pi / 8.93**2, rel=0.01)
    assert not lit[0, 1].any()
    first = (
        build_reflecting_beam(lamp, field).diffuse * ROOM.surface_area * (1.0 - ROOM.mean_albedo)
    )
    # A door of 2 by 2.2 m at 4 m lets 2 x 2.2 / 16 / pi of the light in, less at its edges.
    assert 0.5 * 0.05 * 10_000.0 * 0.5 < first < 0.0875 * 10_000.0 * 0.7


def test_turning_by_one_diode_shifts_the_readings():
    """Turning the drone by one diode shifts the readings by one."""
    field = LightField((LAMP,), DARK, ROOM)
    step = Rotation.from_euler('z', math.pi / 4)
    still = gathered(field, (0.0, 1.0, 1.0))
    turned = gathered(field, (0.0, 1.0, 1.0), tuple(step.as_quat()))
    np.testing.assert_allclose(turned, np.roll(still, -1, axis=1), rtol=2e-2, atol=0.1)
