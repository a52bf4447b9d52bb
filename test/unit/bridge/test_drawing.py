# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is drawn of vehicle and room by hand calculation, and turns by scipy."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.description.scene import (
    draw_body,
    draw_lamp,
    draw_static_scene,
    draw_walls,
    half_power_angle,
)
from lta_bridge.description.shapes import (
    BillboardText,
    BoxShape,
    CylinderShape,
    EllipsoidShape,
    NO_SHIFT,
    PolylineShape,
    rotation_between,
    X,
)
from lta_bridge.description.urdf import list_sensor_frames
from lta_model.light.lamp import direct_illuminance
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

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


@pytest.mark.parametrize('start', [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
def test_a_turn_right_back_is_half_a_turn(start):
    back = tuple(-number for number in start)
    assert applied(rotation_between(start, back), start) == pytest.approx(back)


def test_the_envelope_and_parts_are_where_the_vehicle_file_puts_them():
    entity = draw_body(GTMAB)
    assert entity.frame == 'base_link'
    (hull,) = shapes(entity, EllipsoidShape)
    assert (hull.place, hull.size) == (NO_SHIFT, pytest.approx((1.0, 1.0, 0.599)))
    boxes = {box.place: box.size for box in shapes(entity, BoxShape)}
    assert boxes[(0.0, 0.0, 0.302)] == pytest.approx((0.178, 0.078, 0.002))  # solar panels
    assert len(shapes(entity, BoxShape)) == len(GTMAB.file.parts) - 1  # all but the envelope


def test_rotors_are_discs_across_their_thrust():
    discs = shapes(draw_body(GTMAB), CylinderShape)
    assert [disc.place for disc in discs] == [
        pytest.approx(place)
        for place in ((0, 0.19, -0.3435), (0, -0.19, -0.3435), (0, 0.1, -0.4), (0, -0.1, -0.4))
    ]
    axes = [applied(disc.turn, (0.0, 0.0, 1.0)) for disc in discs]
    assert np.array(axes) == pytest.approx(np.array([[0, 0, 1], [0, 0, 1], [1, 0, 0], [1, 0, 0]]))


def test_the_cone_is_where_the_lamp_shines_half_as_bright():
    source = ROOM.light_field.first_lamp
    angle = half_power_angle(source)
    assert math.degrees(angle) == pytest.approx(60.0)
    far, axis = 5.0, np.array([-1.0, 0.0, 0.0])
    edge = np.array([-math.cos(angle), math.sin(angle), 0.0])
    points = np.array(source.position) + far * np.stack([axis, edge])
    ahead, off = direct_illuminance(source, points, -np.stack([axis, edge]))
    assert off / ahead == pytest.approx(0.5, rel=1e-6)


def test_the_cone_begins_at_the_lamp_and_opens_along_its_axis():
    entity = draw_lamp('lamp', ROOM.lamps['lamp'])
    (cone,) = shapes(entity, CylinderShape)
    assert (cone.bottom, cone.top) == (0.0, 1.0)
    assert math.hypot(cone.size[0] / 2, cone.size[2]) == pytest.approx(1.0)  # along its edge
    tip = np.array(cone.place) + applied(cone.turn, (0.0, 0.0, -cone.size[2] / 2))
    mouth = np.array(cone.place) + applied(cone.turn, (0.0, 0.0, cone.size[2] / 2))
    assert tip == pytest.approx((3.5, 0.0, 1.0))
    assert mouth - tip == pytest.approx((-0.5, 0.0, 0.0), abs=1e-9)
    opening = 2.0 * math.atan2(cone.size[0] / 2, cone.size[2])
    assert math.degrees(opening) == pytest.approx(120.0)
    assert [label.text for label in shapes(entity, BillboardText)] == ['lamp, 150 Hz']


def test_every_lamp_stands_and_every_stop_of_the_route_has_its_circle():
    patrol = load_scenario('warehouse_patrol')
    things = {each.name: each for each in draw_static_scene(patrol)}
    assert list(things) == ['room', 'lamp/dock', 'lamp/aisle', 'lamp/gate', 'goal']
    bulbs = [shapes(things[f'lamp/{name}'], EllipsoidShape)[0].place for name in patrol.lamps]
    assert bulbs == [(-3.5, -2.0, 0.1), (3.5, -2.0, 0.1), (0.0, 4.0, 0.1)]
    cones = [shapes(things[f'lamp/{name}'], CylinderShape)[0] for name in patrol.lamps]
    assert max(cone.size[0] for cone in cones) < 2.0  # of lanterns that shine nearly sideways
    aisle, gate = shapes(things['goal'], PolylineShape)  # dock is on no route
    assert aisle.points[0] == pytest.approx((4.5, -2.0, 0.0))
    assert gate.points[0] == pytest.approx((1.0, 4.0, 0.0))


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
