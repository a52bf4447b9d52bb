"""The scene by hand calculation, turns by scipy, and messages by Protocol Buffers' own rules."""

import math
import struct

from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.live.encoding import encode_frame_transforms, encode_scene_update
from lta_bridge.live.frames import build_vehicle_frame, list_sensor_frames, rotation_from_x
from lta_bridge.live.path_trace import PathTrace, TRACE_POINTS
from lta_bridge.live.room_shapes import draw_lamp, draw_static_scene, draw_walls, half_power_angle
from lta_bridge.live.scene import LiveScene, SceneState
from lta_bridge.live.shapes import (
    ArrowShape,
    BillboardText,
    BoxShape,
    CylinderShape,
    EllipsoidShape,
    ORIGIN,
    PolylineShape,
    rotation_between,
    ShapeEntity,
)
from lta_bridge.live.vehicle_shapes import draw_bearing, draw_body, draw_thrust
from lta_model.light.lamp import direct_illuminance
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

GTMAB, ROOM = load_vehicle('gtmab'), load_scenario('lamp_room')
HALF = math.sqrt(0.5)


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
    assert (hull.place, hull.size) == (ORIGIN, pytest.approx((1.0, 1.0, 0.599)))
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


def test_a_thrust_arrow_is_as_long_as_the_thrust_is_strong():
    """T = a u2 + b u of the Crazyflie's motors; full thrust is half the hull's diameter long."""
    arrows = shapes(
        draw_thrust(GTMAB, {'up_left': 0.5, 'forward_right': 1.0, 'up_right': 0.0}), ArrowShape
    )
    force = 0.0915 * 0.25 + 0.0677 * 0.5
    assert arrows[0].length == pytest.approx(0.5 * force / (0.0915 + 0.0677))
    assert arrows[0].place == pytest.approx((0.0, 0.19, -0.3435))
    assert applied(arrows[0].turn, (1.0, 0.0, 0.0)) == pytest.approx((0.0, 0.0, 1.0), abs=1e-9)
    assert arrows[1].length == pytest.approx(0.5)
    assert applied(arrows[1].turn, (1.0, 0.0, 0.0)) == pytest.approx((1.0, 0.0, 0.0))
    assert len(arrows) == 2


def test_a_reversed_rotor_pulls_back():
    skye = load_vehicle('skye')
    rotor = skye.rotors[0]
    (arrow,) = shapes(draw_thrust(skye, {rotor.name: -1.0}), ArrowShape)
    assert applied(arrow.turn, (1.0, 0.0, 0.0)) == pytest.approx(-np.array(rotor.axis), abs=1e-6)


def test_the_ray_starts_at_the_photodiodes_and_points_where_the_bearing_does():
    (ray,) = shapes(draw_bearing(GTMAB, (0.3, 0.4, 0.0), 2.0), PolylineShape)
    assert ray.points == (pytest.approx((0, 0, -0.33)), pytest.approx((1.2, 1.6, -0.33)))
    assert draw_bearing(GTMAB, ORIGIN, 2.0) == ShapeEntity('bearing', 'base_link', ())


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


def test_the_wind_blows_above_the_vehicle_a_metre_for_each_metre_a_second():
    scene = LiveScene(GTMAB, ROOM)
    state = SceneState((1.0, 2.0, 1.5), (0.0, 0.0, HALF, HALF), {}, ORIGIN, (0.0, -0.7, 0.0))
    wind = {item.name: item for item in scene.draw_moving(state)}['wind']
    assert wind.frame == 'map'
    ((arrow),) = wind.shapes
    assert arrow.length == pytest.approx(0.7)
    assert arrow.place == pytest.approx((1.0, 2.0, 1.5 + 0.5 + 0.2))
    assert applied(arrow.turn, (1.0, 0.0, 0.0)) == pytest.approx((0.0, -1.0, 0.0), abs=1e-9)
    calm = {item.name: item for item in scene.draw_moving(state._replace(wind=ORIGIN))}['wind']
    assert calm.shapes == ()
    first, *_ = scene.list_frames(state)
    assert first == ('map', 'base_link', (1.0, 2.0, 1.5), (0.0, 0.0, HALF, HALF))


@given(st.lists(st.tuples(*[st.floats(-5.0, 5.0)] * 3), min_size=1, max_size=30))
def test_a_path_begins_where_the_flight_did_and_has_no_crowd(places):
    track = PathTrace()
    for place in places:
        track.add_position(place)
    assert track.points[0] == places[0]
    for before, after in zip(track.points, track.points[1:], strict=False):
        assert math.dist(before, after) >= track.step


def test_a_long_path_stays_short_and_reaches_to_the_end():
    track = PathTrace()
    for k in range(100_000):
        track.add_position((0.01 * k, 0.0, 0.0))
    assert TRACE_POINTS / 2 <= len(track.points) <= TRACE_POINTS
    assert track.points[0] == ORIGIN
    assert math.dist(track.points[-1], (999.99, 0.0, 0.0)) <= 2 * track.step
    (line,) = track.to_entity('map').shapes
    assert line.points == tuple(track.points)


@pytest.mark.parametrize(
    'name', ['beavis', 'blimp2b', 'gtmab', 'multirotor', 'rgblimp', 'sblimp', 'skye']
)
def test_every_vehicle_can_be_drawn(name):
    vehicle = load_vehicle(name)
    scene = LiveScene(vehicle, ROOM)
    duties = dict.fromkeys(vehicle.rotor_names, 0.5)
    state = SceneState(
        (0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), duties, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    )
    told = message(
        encode_scene_update([*scene.standing, *scene.draw_moving(state), scene.draw_path()], 0)
    )
    assert len(told[2]) == 8
    drawn = {message(item)[3][0].decode(): message(item) for item in told[2]}
    assert len(drawn['vehicle'][10]) == len(drawn['thrust'][7]) == len(vehicle.rotors)


anything = st.tuples(*[st.floats()] * 3)


@given(anything, st.tuples(*[st.floats()] * 4), anything, anything, st.floats())
def test_nonsense_is_drawn_somehow(place, turn, seen, wind, duty):
    scene = LiveScene(GTMAB, ROOM)
    state = SceneState(place, turn, {'up_left': duty, 'nobody': duty}, seen, wind)
    for _ in range(2):
        entities = [*scene.draw_moving(state), scene.draw_path()]
    assert len(message(encode_scene_update(entities, 0))[2]) == 4
    assert message(encode_frame_transforms(scene.list_frames(state), 0))


def message(data):
    """Return a Protocol Buffers message: values by field number, from its wire format alone."""
    found, at = {}, 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    while at < len(data):
        number, kind = divmod(varint(), 8)
        if kind == 0:
            value = varint()
        else:
            size = {1: 8, 5: 4}.get(kind) or varint()
            value = data[at : at + size]
            at += size
            if kind == 1:
                (value,) = struct.unpack('<d', value)
        found.setdefault(number, []).append(value)
    return found


def numbers(data, count):
    """Return x y z (w) of a message; Protocol Buffers leave zeros out."""
    fields = message(data)
    return tuple(fields.get(k, [0.0])[0] for k in range(1, count + 1))


def test_an_arrow_is_written_as_foxglove_publishes_it():
    """SceneUpdate.proto: entities 2; SceneEntity: frame 2, id 3, locked 5, arrows 7."""
    arrow = ArrowShape((1.0, 2.0, 3.0), 0.8, 0.04, (1.0, 0.5, 0.25, 1.0), (0.0, -HALF, 0.0, HALF))
    whole = message(
        encode_scene_update([ShapeEntity('thrust', 'base_link', (arrow,))], 2_500_000_000)
    )
    (entity,) = map(message, whole[2])
    assert (entity[2], entity[3], entity[5]) == ([b'base_link'], [b'thrust'], [1])
    assert message(entity[1][0])[1] == [2]
    written = message(entity[7][0])
    pose = message(written[1][0])
    assert numbers(pose[1][0], 3) == (1.0, 2.0, 3.0)
    assert numbers(pose[2][0], 4) == (0.0, -HALF, 0.0, HALF)
    shaft, width, head, head_width = (written[k][0] for k in (2, 3, 4, 5))
    assert shaft + head == pytest.approx(0.8)
    assert (width, head_width) == (0.04, 0.08)


def test_frames_are_written_as_foxglove_publishes_them():
    """FrameTransforms.proto: transforms 1; each: parent 2, child 3, translation 4, rotation 5."""
    data = encode_frame_transforms(
        [build_vehicle_frame((1.0, -2.0, 0.5), (0.0, 0.0, 1.0, 0.0))], 10**9
    )
    (transform,) = map(message, message(data)[1])
    assert (transform[2], transform[3]) == ([b'map'], [b'base_link'])
    assert numbers(transform[4][0], 3) == (1.0, -2.0, 0.5)
    assert numbers(transform[5][0], 4) == (0.0, 0.0, 1.0, 0.0)


@pytest.mark.parametrize('axis', [(0, 0, 1), (0, -1, 0), (1, 0, 0), (-1, 0, 0), (0.6, 0, -0.8)])
def test_a_panel_looks_where_its_normal_points(axis):
    turned = Rotation.from_quat(rotation_from_x(axis)).apply((1.0, 0.0, 0.0))
    assert turned == pytest.approx(axis, abs=1e-12)
