# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Topics with several bodies, and numbers without names, in bags of ROS 2."""

from operator import attrgetter
from typing import Any

from lta_config.errors import BadInput
from lta_data.importers.draft.draft_mapping import draft_mapping, MappingDraft
from mcap_ros2.writer import Writer
import numpy as np
import pytest
import yaml

from .lab_flights import lab_flight

RULE = '\n' + '=' * 80 + '\nMSG: '
HEADER = RULE.join([
    '', 'std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id',
    'builtin_interfaces/Time\nint32 sec\nuint32 nanosec',
])  # fmt: skip
QUATERNION = RULE + 'geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w'
POINT = RULE + 'geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z'
POSE = RULE + 'geometry_msgs/Pose\ngeometry_msgs/Point position\n' + (
    'geometry_msgs/Quaternion orientation' + POINT + QUATERNION
)  # fmt: skip
TRANSFORMS = (
    'geometry_msgs/TransformStamped[] transforms' + RULE + 'geometry_msgs/TransformStamped\n'
    'std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform' + RULE
    + 'geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n'
    'geometry_msgs/Quaternion rotation' + RULE
    + 'geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z' + QUATERNION + HEADER
)  # fmt: skip
POSES = (
    'std_msgs/Header header\nNamedPose[] poses' + RULE
    + 'motion_capture_tracking_interfaces/NamedPose\nstring name\ngeometry_msgs/Pose pose'
    + POSE + HEADER
)  # fmt: skip
GENERIC = 'std_msgs/Header header\nuint32 timestamp\nfloat32[] values' + HEADER
START = 1_700_000_000_000_000_000  # ns


def stamp(time: float) -> tuple[dict[str, Any], int]:
    at = START + round(time * 1e9)
    return {'stamp': dict(zip(('sec', 'nanosec'), divmod(at, 10**9), strict=True)),
            'frame_id': 'world'}, at  # fmt: skip


def named(axes, values):
    return dict(zip(axes, map(float, values), strict=True))


def write_transforms(writer, f, bodies):
    kind = writer.register_msgdef('tf2_msgs/msg/TFMessage', TRANSFORMS)
    for k, time in enumerate(f['t']):
        head, at = stamp(time)
        listed = [
            {'header': head, 'child_frame_id': name, 'transform': {
                'translation': named('xyz', place[k]), 'rotation': named('xyzw', f['q'][k])}}
            for name, place in bodies.items()
        ]  # fmt: skip
        writer.write_message('/tf', kind, {'transforms': listed}, at, at)


def write_named_poses(writer, f, bodies):
    kind = writer.register_msgdef(
        'motion_capture_tracking_interfaces/msg/NamedPoseArray',
        POSES.replace('NamedPose[]', 'motion_capture_tracking_interfaces/NamedPose[]'),
    )
    for k, time in enumerate(f['t']):
        head, at = stamp(time)
        listed = [
            {'name': name, 'pose': {'position': named('xyz', place[k]),
                                    'orientation': named('xyzw', f['q'][k])}}
            for name, place in bodies.items()
        ]  # fmt: skip
        # Recorded late: the stamp of the message counts
        writer.write_message('/poses', kind, {'header': head, 'poses': listed}, at + 7, at + 7)


WRITERS = {'/tf': write_transforms, '/poses': write_named_poses}


def draft_bag(path, write, f, bodies, **answers) -> MappingDraft:
    with path.open('wb') as stream:
        writer = Writer(stream)
        write(writer, f, bodies)
        writer.finish()
    return draft_mapping(path, answers)


@pytest.mark.parametrize('topic', WRITERS)
def test_the_only_body_that_moves_is_the_vehicle(topic, tmp_path, bring):
    f = lab_flight()
    bodies = {'wand': np.ones_like(f['p']), 'blimp': f['p']}
    source = tmp_path / 'a.mcap'
    draft = draft_bag(source, WRITERS[topic], f, bodies)
    assert draft.choices.questions == []
    assert any(f'{topic}#wand' in reason.reason for reason in draft.choices.reasons)
    got = bring(source, draft.text)
    poses = got.messages['/lta1/ground_truth/odom']
    places = [[getattr(one.pose.pose.position, axis) for axis in 'xyz'] for one in poses]
    np.testing.assert_allclose(places, f['p'])
    assert got.stamps('/lta1/ground_truth/odom')[3] == START + round(f['t'][3] * 1e9)


@pytest.mark.parametrize('topic', WRITERS)
def test_of_several_that_move_the_user_chooses(topic, tmp_path):
    f = lab_flight()
    bodies = {'one': f['p'], 'two': -f['p']}
    (question,) = draft_bag(tmp_path / 'a.mcap', WRITERS[topic], f, bodies).choices.questions
    assert {name for name, _ in question.options} == {f'{topic}#one', f'{topic}#two'}
    draft = draft_mapping(tmp_path / 'a.mcap', {question.key: f'{topic}#two'})
    assert yaml.safe_load(draft.text)['topics'][0]['table'] == f'{topic}#two'


def test_the_clock_in_a_message_of_numbers_is_no_rotor(tmp_path):
    f = lab_flight()

    def write(writer, f, bodies):
        write_named_poses(writer, f, bodies)
        kind = writer.register_msgdef('crazyflie_interfaces/msg/LogDataGeneric', GENERIC)
        for time in f['t']:
            head, at = stamp(time)
            pwm = [65535.0 * (0.4 + 0.2 * np.sin(time + k)) for k in range(4)]
            message = {'header': head, 'timestamp': round(1e3 * time), 'values': pwm}
            writer.write_message('/cf7/motor_log', kind, message, at, at)

    draft = draft_bag(tmp_path / 'a.mcap', write, f, {'cf7': f['p']})
    (motors,) = (t for t in yaml.safe_load(draft.text)['topics'] if t['topic'] == 'motors')
    columns = [one['effort']['column'] for one in motors['actuators'].values()]
    assert columns == [f'values[{k}]' for k in range(4)]


def test_an_attitude_that_is_nan_throughout_is_left_out(tmp_path):
    f = lab_flight()
    f['q'] = np.full_like(f['q'], np.nan)
    draft = draft_bag(tmp_path / 'a.mcap', write_named_poses, f, {'ball': f['p']})
    readings = {one.part: one.reading for one in draft.choices.reasons}
    assert readings['ground_truth/odom: orientation'] == 'left out'


def write_values(writer, topic, f, rows):
    kind = writer.register_msgdef('crazyflie_interfaces/msg/LogDataGeneric', GENERIC)
    for time, row in zip(f['t'], rows, strict=True):
        head, at = stamp(time)
        message = {'header': head, 'timestamp': round(1e3 * time), 'values': row.tolist()}
        writer.write_message(topic, kind, message, at, at)


@pytest.mark.parametrize('parts', ['pqvw', 'wqvp', 'qp'])
def test_values_without_names_are_what_their_motion_says(parts, tmp_path, bring):
    f = lab_flight()
    rows = np.hstack([f[part] for part in parts])
    source = tmp_path / 'a.mcap'
    draft = draft_bag(source, lambda writer, f, _: write_values(writer, '/cf7/a', f, rows), f, {})
    assert draft.choices.questions == []
    odometry = bring(source, draft.text).messages['/lta1/ground_truth/odom']
    for part, path, axes in (
        ('p', 'pose.pose.position', 'xyz'), ('q', 'pose.pose.orientation', 'xyzw'),
        ('v', 'twist.twist.linear', 'xyz'), ('w', 'twist.twist.angular', 'xyz'),
    ):  # fmt: skip
        got = [[attrgetter(f'{path}.{axis}')(one) for axis in axes] for one in odometry]
        if part in parts:
            np.testing.assert_allclose(got, f[part], atol=1e-6)


def test_the_sign_of_a_pitch_without_a_name_is_asked(tmp_path):
    f = lab_flight()
    rows = np.hstack([f['p'], np.degrees(f['rpy'])])
    source = tmp_path / 'a.mcap'
    draft = draft_bag(source, lambda writer, f, _: write_values(writer, '/cf7/a', f, rows), f, {})
    (question,) = draft.choices.questions
    assert [name for name, _ in question.options] == [
        'ZYX, deg, body to world', 'ZYX, deg, body to world, pitch inverted',
    ]  # fmt: skip


def test_which_block_of_values_commands_is_asked(tmp_path):
    f = lab_flight()

    def write(writer, f, bodies):
        write_named_poses(writer, f, bodies)
        write_values(writer, '/cf7/block', f, 0.5 + 0.1 * np.sin(f['p'] @ np.ones((3, 2))))

    draft = draft_bag(tmp_path / 'a.mcap', write, f, {'cf7': f['p']})
    assert [one.key for one in draft.choices.questions] == ['commands.table']
    assert 'motors' not in draft.text
    draft = draft_mapping(tmp_path / 'a.mcap', {'commands.table': '/cf7/block'})
    assert yaml.safe_load(draft.text)['topics'][1]['table'] == '/cf7/block'


def test_an_imu_of_a_bag_is_read_as_the_pose_beside_it_turns(tmp_path, bring):
    """In deg/s and g, down and to the right, at twice the rate of the poses."""
    f = lab_flight()
    down = np.array([1.0, -1.0, -1.0])
    vector = RULE + 'geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z'
    imu = 'std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n' + '\n'.join(
        f'float64[9] {name}_covariance' + f'\ngeometry_msgs/Vector3 {following}' * bool(following)
        for name, following in (('orientation', 'angular_velocity'),
                                ('angular_velocity', 'linear_acceleration'),
                                ('linear_acceleration', ''))
    ) + vector + QUATERNION + HEADER  # fmt: skip
    source = tmp_path / 'log.mcap'
    with source.open('wb') as stream:
        writer = Writer(stream)
        posed = writer.register_msgdef(
            'geometry_msgs/msg/PoseStamped',
            'std_msgs/Header header\ngeometry_msgs/Pose pose' + POSE + HEADER,
        )
        sensed = writer.register_msgdef('sensor_msgs/msg/Imu', imu)
        unknown = {f'{name}_covariance': [0.0] * 9 for name in (
            'orientation', 'angular_velocity', 'linear_acceleration')}  # fmt: skip
        for k, time in enumerate(f['t']):
            head, at = stamp(time)
            writer.write_message('/mocap/pose', posed, {'header': head, 'pose': {
                'position': named('xyz', f['p'][k]), 'orientation': named('xyzw', f['q'][k])}},
                at, at)  # fmt: skip
            for late in (0.0, 0.01):
                head, at = stamp(time + late)
                writer.write_message('/imu/data', sensed, unknown | {
                    'header': head, 'orientation': named('xyzw', [0.0, 0.0, 0.0, 1.0]),
                    'angular_velocity': named('xyz', np.degrees(f['w'][k]) * down),
                    'linear_acceleration': named('xyz', f['a'][k] * down / 9.80665),
                }, at, at)  # fmt: skip
        writer.finish()
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    read = bring(source, draft.text)
    turned = [message.angular_velocity for message in read.messages['/lta1/imu']]
    felt = [message.linear_acceleration for message in read.messages['/lta1/imu']]
    axes = attrgetter('x', 'y', 'z')
    np.testing.assert_allclose([*map(axes, turned)], np.repeat(f['w'], 2, axis=0), atol=1e-6)
    np.testing.assert_allclose([*map(axes, felt)], np.repeat(f['a'], 2, axis=0), atol=1e-6)


def test_a_topic_of_the_errors_of_a_pose_is_no_pose(tmp_path):
    f = lab_flight()

    def write(writer, f, topics):
        posed = writer.register_msgdef(
            'geometry_msgs/msg/PoseStamped',
            'std_msgs/Header header\ngeometry_msgs/Pose pose' + POSE + HEADER,
        )
        for k, time in enumerate(f['t']):
            head, at = stamp(time)
            for topic, scale in topics.items():
                pose = {
                    'position': named('xyz', scale * f['p'][k]),
                    'orientation': named('xyzw', f['q'][k]),
                }
                writer.write_message(topic, posed, {'header': head, 'pose': pose}, at, at)

    draft = draft_bag(tmp_path / 'a.mcap', write, f, {'/pose': 1.0, '/pose_error': 3.0})
    assert draft.choices.questions == []
    tables = [one['table'] for one in yaml.safe_load(draft.text)['topics']]
    assert tables == ['/pose']
    with pytest.raises(BadInput, match='becomes one of ours by its type and name'):
        draft_bag(tmp_path / 'b.mcap', write, f, {'/pose_error': 3.0})
