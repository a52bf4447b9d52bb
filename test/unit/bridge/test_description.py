# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The URDF of every shipped vehicle: frames, mass and hull by what the vehicle file says."""

import itertools
import math
from pathlib import Path
from xml.etree import ElementTree

from lta_bridge.description.messages import (
    build_marker_array,
    iterate_descriptions,
    list_cone_triangles,
)
from lta_bridge.description.scene import draw_static_scene
from lta_bridge.description.shapes import (
    BillboardText,
    CylinderShape,
    EllipsoidShape,
    PolylineShape,
)
from lta_bridge.description.urdf import (
    build_urdf,
    convert_to_rods,
    list_fixed_frames,
    list_sensor_frames,
    slice_into_discs,
    to_rpy,
)
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
    for given in itertools.product(angles, pitches, angles):
        turn = Rotation.from_euler('xyz', given)
        assert to_rpy(turn.as_quat()) == pytest.approx(given, abs=1e-12)
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


def test_joints_turn_as_the_frames_of_messages_do():
    """x of range_link points down, z of a rotor along its thrust, whatever rpy says it by."""
    vehicle = load_vehicle('gtmab')
    robot = ElementTree.fromstring(build_urdf(vehicle))
    turns = {
        joint.find('child').get('link'): Rotation.from_euler(
            'xyz', numbers(joint.find('origin').get('rpy'))
        )
        for joint in robot.iter('joint')
    }
    assert set(turns) == {frame.name for frame in list_fixed_frames(vehicle)}
    assert turns['range_link'].apply([1.0, 0.0, 0.0]) == pytest.approx([0.0, 0.0, -1.0], abs=1e-5)
    for rotor in vehicle.rotors:
        z = turns[f'rotor_{rotor.name}'].apply([0.0, 0.0, 1.0])
        assert z == pytest.approx(rotor.axis, abs=1e-5)
    for frame in list_sensor_frames(vehicle):
        own = Rotation.from_quat(frame.turn)
        assert (turns[frame.name].inv() * own).magnitude() < 1e-5


@pytest.mark.parametrize(
    ('size', 'axis'), [((1.0, 1.0, 0.6), 2), ((2.0, 0.8, 0.8), 0), ((0.8, 2.0, 0.8), 1)]
)
def test_the_discs_fill_the_hull_and_stand_along_its_axis(size, axis):
    made = list(slice_into_discs(EllipsoidShape((0.0, 0.0, 0.0), size, (0, 0, 0, 1))))
    volume = sum(math.pi * (0.5 * disc.size[0]) ** 2 * disc.size[2] for disc in made)
    assert volume == pytest.approx(math.pi / 6.0 * math.prod(size), rel=1e-9)
    assert sum(disc.size[2] for disc in made) == pytest.approx(size[axis])
    up = Rotation.from_quat(made[0].turn).apply([0.0, 0.0, 1.0])
    assert abs(up[axis]) == pytest.approx(1.0)


def test_a_rod_joins_the_ends_of_its_stroke():
    ends = ((0.1, 0.0, 0.2), (0.4, -0.4, 0.2))
    (rod,) = convert_to_rods(PolylineShape(ends, 0.01, (0, 0, 0, 1), pairs=True))
    half = Rotation.from_quat(rod.turn).apply([0.0, 0.0, 0.5 * rod.size[2]])
    assert np.array(rod.place) - half == pytest.approx(ends[0])
    assert np.array(rod.place) + half == pytest.approx(ends[1])


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


def test_a_real_drone_has_no_scene():
    assert [name for name, _ in iterate_descriptions(load_vehicle('gtmab'), None)] == [
        'robot_description',
        '/tf_static',
    ]


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
