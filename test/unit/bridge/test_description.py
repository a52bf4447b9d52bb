# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What viewers are shown: one tree of frames, shapes and markers where the files say."""

import itertools
import math
from pathlib import Path
from xml.etree import ElementTree

from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.description.messages import (
    build_marker_array,
    iterate_descriptions,
    list_cone_triangles,
)
from lta_bridge.description.urdf import (
    build_urdf,
    list_fixed_frames,
    list_sensor_frames,
    to_rpy,
)
from lta_model.drawing.scene import (
    draw_body,
    draw_static_scene,
    draw_walls,
    half_power_angle,
)
from lta_model.drawing.shapes import (
    BillboardText,
    BoxShape,
    CylinderShape,
    EllipsoidShape,
    NO_SHIFT,
    PolylineShape,
    rotation_between,
    X,
)
from lta_model.light.lamp import direct_illuminance
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from visualization_msgs.msg import Marker

VEHICLES = sorted(path.stem for path in Path(__file__).parents[3].glob('config/vehicles/*.yaml'))


def numbers(text):
    return np.array(list(map(float, text.split())))


def test_rpy_is_that_of_scipy():
    angles = np.linspace(-3.0, 3.0, 7)
    pitches = [-1.5, -0.4, 0.0, 1.2]
    for wanted in itertools.product(angles, pitches, angles):
        turn = Rotation.from_euler('xyz', wanted)
        assert to_rpy(turn.as_quat()) == pytest.approx(wanted, abs=1e-12)
    for roll, pitch, yaw in itertools.product(angles, [-math.pi / 2, math.pi / 2], angles):
        turn = Rotation.from_euler('xyz', [roll, pitch, yaw])
        assert to_rpy(turn.as_quat())[2] == 0.0
        assert (Rotation.from_euler('xyz', to_rpy(turn.as_quat())).inv() * turn).magnitude() < 1e-7


@pytest.mark.parametrize('name', VEHICLES)
def test_it_is_one_tree_with_the_mass_of_the_vehicle(name):
    vehicle = load_vehicle(name)
    robot = ElementTree.fromstring(build_urdf(vehicle))
    links = [link.get('name') for link in robot.iter('link') if link.get('name')]
    children = [joint.find('child').get('link') for joint in robot.iter('joint')]
    assert len(set(links)) == len(links)
    assert set(links) - set(children) == {'base_link'}
    assert {joint.find('parent').get('link') for joint in robot.iter('joint')} <= set(links)
    # KDL wants none in the root
    (link,) = [link for link in robot.iter('link') if link.find('inertial') is not None]
    joint = robot.find('joint[@name="cg_link_joint"]')
    inertial = link.find('inertial')
    assert link.get('name') == 'cg_link'
    assert float(inertial.find('mass').get('value')) == pytest.approx(vehicle.mass)
    assert numbers(joint.find('origin').get('xyz')) == pytest.approx(vehicle.cg, abs=1e-6)
    assert float(inertial.find('inertia').get('iyy')) == pytest.approx(vehicle.inertia[1, 1])


def test_descriptions_are_urdf_scene_and_fixed_frames():
    vehicle = load_vehicle('gtmab')
    found = dict(iterate_descriptions(vehicle, load_scenario('lamp_room')))
    assert found['robot_description'].data == build_urdf(vehicle)
    assert {marker.ns for marker in found['scene'].markers} >= {'room', 'goal'}
    frames = {one.child_frame_id: one for one in found['/tf_static'].transforms}
    assert set(frames) == {frame.name for frame in list_fixed_frames(vehicle)}
    fixed = frames['range_link']
    frame = next(f for f in list_fixed_frames(vehicle) if f.name == 'range_link')
    assert fixed.header.frame_id == 'base_link'
    assert fixed.transform.translation.z == pytest.approx(frame.place[2])
    turn = fixed.transform.rotation
    assert (turn.x, turn.y, turn.z, turn.w) == pytest.approx(frame.turn)


@pytest.mark.parametrize('name', ['lamp_room', 'warehouse', 'windy_field'])
def test_every_shape_of_a_scene_is_one_marker(name):
    entities = draw_static_scene(load_scenario(name))
    markers = build_marker_array(entities).markers
    assert len(markers) == sum(len(entity.shapes) for entity in entities)
    assert len({(marker.ns, marker.id) for marker in markers}) == len(markers)
    assert {marker.header.frame_id for marker in markers} == {'map'}
    # RViz draws nothing without a size or a colour
    assert all(max(m.scale.x, m.scale.y, m.scale.z) > 0.0 < m.color.a for m in markers)
    shapes = [shape for entity in entities for shape in entity.shapes]
    for marker, shape in zip(markers, shapes, strict=True):
        if isinstance(shape, BillboardText):
            assert (marker.type, marker.text) == (Marker.TEXT_VIEW_FACING, shape.text)
        if isinstance(shape, PolylineShape):
            assert [(p.x, p.y, p.z) for p in marker.points] == list(shape.points)
        if isinstance(shape, EllipsoidShape):
            size = marker.scale
            assert (marker.type, (size.x, size.y, size.z)) == (Marker.SPHERE, shape.size)


def test_the_mantle_of_a_cone():
    """A point at the bottom, a circle of the radius at the top, and the area of the mantle."""
    cone = CylinderShape((0.0, 0.0, 0.0), (1.0, 1.0, 2.0), (1.0, 1.0, 1.0, 1.0), bottom=0.0)
    corners = np.array(list_cone_triangles(cone))
    assert corners[corners[:, 2] < 0.0][:, :2] == pytest.approx(0.0)
    rim = corners[corners[:, 2] > 0.0]
    assert np.hypot(rim[:, 0], rim[:, 1]) == pytest.approx(0.5)
    a, b, c = corners.reshape(-1, 3, 3).transpose(1, 0, 2)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    # Radius times slant height times pi; 24 flat sides have 1 % less
    assert area == pytest.approx(math.pi * 0.5 * math.hypot(0.5, 2.0), rel=0.015)


GTMAB, ROOM = load_vehicle('gtmab'), load_scenario('lamp_room')


def shapes(entity, kind):
    return [shape for shape in entity.shapes if isinstance(shape, kind)]


def applied(turn, vector):
    return Rotation.from_quat(turn).apply(vector)


unit = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: math.hypot(*v) > 1e-3)


@given(unit, unit)
def test_a_turn_takes_one_direction_onto_the_other(start, end):
    start = tuple(number / math.hypot(*start) for number in start)
    got = applied(rotation_between(start, end), start)
    assert got == pytest.approx(np.array(end) / math.hypot(*end), abs=1e-6)


def test_the_envelope_and_parts_are_where_the_vehicle_file_puts_them():
    entity = draw_body(GTMAB)
    assert entity.frame == 'base_link'
    (hull,) = shapes(entity, EllipsoidShape)
    assert (hull.place, hull.size) == (NO_SHIFT, pytest.approx((1.0, 1.0, 0.599)))
    boxes = {box.place: box.size for box in shapes(entity, BoxShape)}
    assert boxes[(0.0, 0.0, 0.302)] == pytest.approx((0.178, 0.078, 0.002))  # solar panels
    assert len(shapes(entity, BoxShape)) == len(GTMAB.file.parts) - 1  # all but the envelope


def test_the_cone_is_where_the_lamp_shines_half_as_bright():
    source = ROOM.light_field.first_lamp
    angle = half_power_angle(source)
    assert math.degrees(angle) == pytest.approx(60.0)
    far, axis = 5.0, np.array([-1.0, 0.0, 0.0])
    edge = np.array([-math.cos(angle), math.sin(angle), 0.0])
    points = np.array(source.position) + far * np.stack([axis, edge])
    ahead, off = direct_illuminance(source, points, -np.stack([axis, edge]))
    assert off / ahead == pytest.approx(0.5, rel=1e-6)


def test_the_room_has_a_floor_twelve_edges_and_walls_only_where_they_are_solid():
    entity = draw_walls(ROOM)
    (floor,) = shapes(entity, BoxShape)
    assert floor.size[:2] == (10.0, 8.0)
    assert floor.place[2] + floor.size[2] / 2 == 0.0
    (edges,) = shapes(entity, PolylineShape)
    pairs = list(zip(edges.points[::2], edges.points[1::2], strict=True))
    assert len({frozenset(pair) for pair in pairs}) == 12
    lengths = sorted(math.dist(*pair) for pair in pairs)
    assert lengths == [3.0] * 4 + [8.0] * 4 + [10.0] * 4
    solid = ROOM.model_copy(update={'room': ROOM.room.model_copy(update={'walls': 'solid'})})
    assert len(shapes(draw_walls(solid), BoxShape)) == 5
    (ring,) = shapes(draw_static_scene(ROOM)[2], PolylineShape)
    assert {round(math.dist(point, (3.5, 0.0, 0.0)), 9) for point in ring.points} == {1.0}


def test_frames_are_where_the_sensors_are_and_point_as_their_messages_want():
    found = {frame.name: frame for frame in list_sensor_frames(GTMAB)}
    assert {frame.parent for frame in found.values()} == {'base_link'}
    assert found['imu_link'].place == pytest.approx((0.0, 0.0, -0.36))
    assert found['range_link'].place == pytest.approx((0.0, 0.0, -0.37))
    assert found['panel_link'].place == pytest.approx((0.0, 0.0, 0.302))
    x = {name: applied(frame.turn, (1.0, 0.0, 0.0)) for name, frame in found.items()}
    assert x['imu_link'] == pytest.approx((1.0, 0.0, 0.0))
    assert x['range_link'] == pytest.approx((0.0, 0.0, -1.0))
    assert x['panel_link'] == pytest.approx((0.0, 0.0, 1.0))


@pytest.mark.parametrize('axis', [(0, 0, 1), (0, -1, 0), (1, 0, 0), (-1, 0, 0), (0.6, 0, -0.8)])
def test_a_panel_looks_where_its_normal_points(axis):
    turned = Rotation.from_quat(rotation_between(X, axis)).apply((1.0, 0.0, 0.0))
    assert turned == pytest.approx(axis, abs=1e-12)
