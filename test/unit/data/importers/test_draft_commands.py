# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Commands of body axes become a wrench, numbers of arrays are asked for, and rotors get names."""

from lta_config.errors import BadInput
from lta_data.importers.draft.choices import DraftVehicle
from lta_data.importers.draft.draft_mapping import draft_mapping
import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import get_typestore, Stores
from scipy.spatial.transform import Rotation
import yaml

from .lab_flights import lab_flight, three, write_csv

POSE, ARRAY = 'geometry_msgs/msg/PoseStamped', 'std_msgs/msg/Float32MultiArray'
LARGEST = {'surge': 0.12, 'heave': 0.06, 'yaw': 0.02}
WHALE = DraftVehicle('whale', ('left', 'right', 'up'), LARGEST, {})
SHARES = ('u_surge', 'u_heave', 'u_yaw')


def write_commands(path, names, size=0.9):
    """Write a flight with commands that change every two seconds."""
    f = lab_flight()
    rng = np.random.default_rng(2)
    held = np.repeat(rng.uniform(-size, size, (16, len(names))), 100, axis=0)[: len(f['t'])]
    columns = {name: held[:, k] for k, name in enumerate(names)}
    return write_csv(path, {'t': f['t'] + 9.0, **three('p', f['p']),
                            **three('q', f['q'], 'xyzw'), **columns})  # fmt: skip


def find_topic(draft, topic):
    found = [one for one in yaml.safe_load(draft.text)['topics'] if one['topic'] == topic]
    return found[0] if found else None


def test_shares_of_body_axes_are_forces_by_the_vehicle_file(tmp_path):
    draft = draft_mapping(write_commands(tmp_path / 'a.csv', SHARES), {}, WHALE)
    assert draft.choices.questions == []
    assert find_topic(draft, 'motors') is None
    wrench = find_topic(draft, 'wrench_command')
    assert wrench['force'] == {
        'columns': ['u_surge', None, 'u_heave'], 'unit': 'N', 'scale': [0.12, 0.0, 0.06],
    }  # fmt: skip
    assert wrench['torque']['columns'] == [None, None, 'u_yaw']
    assert wrench['torque']['scale'] == [0.0, 0.0, 0.02]


def test_forces_act_where_the_rotors_of_the_vehicle_file_push(tmp_path, bring):
    whale = WHALE._replace(centres={'surge': (0.0, 0.0, -0.34), 'heave': (0.02, 0.0, -0.3)})
    source = write_commands(tmp_path / 'a.csv', SHARES)
    draft = draft_mapping(source, {}, whale)
    assert draft.unused == []
    (wrench,) = bring(source, draft.text).messages['/lta1/wrench_command'][:1]
    u, w, r = np.loadtxt(source, delimiter=',', skiprows=1)[0, 8:]
    force, torque = wrench.wrench.force, wrench.wrench.torque
    assert (force.x, force.y, force.z) == pytest.approx((0.12 * u, 0.0, 0.06 * w))
    pitch = -0.34 * 0.12 * u - 0.02 * 0.06 * w  # z Fx - x Fz
    assert (torque.x, torque.y, torque.z) == pytest.approx((0.0, pitch, 0.02 * r))


def test_without_a_vehicle_the_largest_force_of_each_axis_is_asked(tmp_path):
    source = write_commands(tmp_path / 'a.csv', SHARES)
    asked = [one.key for one in draft_mapping(source, {}).choices.questions]
    assert asked == ['surge.largest', 'heave.largest', 'yaw.largest']
    answers = dict(zip(asked, ('80 mN', '0.05 N', '4 mN m'), strict=True))
    draft = draft_mapping(source, answers)
    assert draft.choices.questions == []
    assert find_topic(draft, 'wrench_command')['force']['scale'] == [0.08, 0.0, 0.05]
    with pytest.raises(BadInput, match=r'surge\.largest is .3 m., but must be above 0 N'):
        draft_mapping(source, {**answers, 'surge.largest': '3 m'})


@pytest.mark.parametrize(
    ('names', 'size', 'scale'),
    [
        (('cmd_surge [mN]', 'cmd_yaw [mN m]'), 90.0, 0.001),
        (('force_surge', 'moment_yaw'), 0.1, None),
        (('u_surge', 'u_yaw'), 95.0, [0.0012, 0.0, 0.0]),
    ],
)
def test_units_and_words_decide_what_a_command_is(tmp_path, names, size, scale):
    draft = draft_mapping(write_commands(tmp_path / 'a.csv', names, size), {}, WHALE)
    assert draft.choices.questions == []
    assert find_topic(draft, 'wrench_command')['force'].get('scale') == scale


@pytest.mark.parametrize(
    'names',
    [
        ('cmd_surge_N', 'cmd_heave_N', 'cmd_yaw_mN_m'),
        ('surge_cmd_N', 'heave_cmd_N', 'yaw_cmd_mNm'),
    ],
)
def test_a_unit_at_the_end_of_a_name_needs_no_question(tmp_path, names):
    draft = draft_mapping(write_commands(tmp_path / 'a.csv', names, 0.1), {})
    assert draft.choices.questions == []
    wrench = find_topic(draft, 'wrench_command')
    assert wrench['force'] == {'columns': [names[0], None, names[1]], 'unit': 'N'}
    assert wrench['torque'] == {'columns': [None, None, names[2]], 'unit': 'N m', 'scale': 1e-3}
    reasons = {one.part: one.reason for one in draft.choices.reasons}
    assert reasons['wrench_command: force'].endswith('; sway without a column: taken as zero')


def test_the_reasons_name_the_axes_without_a_force(tmp_path):
    draft = draft_mapping(write_commands(tmp_path / 'a.csv', ('fx_N', 'fz_N', 'tz_Nm')), {})
    reasons = {one.part: one.reason for one in draft.choices.reasons}
    assert reasons['wrench_command: force'].endswith('; y without a column: taken as zero')
    assert reasons['wrench_command: torque'].endswith('; x and y without a column: taken as zero')
    readings = {one.part: one.reading for one in draft.choices.reasons}
    assert readings['wrench_command: torque'] == 'N m'


@pytest.mark.parametrize(
    'names',
    [
        ('u_x', 'u_z', 'u_yaw'),
        ('u_fwd', 'u_up', 'u_yaw'),
        ('wrench_x', 'wrench_z', 'wrench_yaw'),
        ('cmd_vel.linear.x', 'cmd_vel.linear.z', 'cmd_vel.angular.z'),
    ],
)
def test_a_command_may_name_its_axis_in_other_words(tmp_path, names):
    draft = draft_mapping(write_commands(tmp_path / 'a.csv', names), {}, WHALE)
    assert draft.choices.questions == []
    wrench = find_topic(draft, 'wrench_command')
    assert wrench['force']['columns'] == [names[0], None, names[1]]
    assert wrench['torque']['columns'] == [None, None, names[2]]


@pytest.mark.parametrize(
    ('names', 'called'),
    [
        (('cmd_left', 'cmd_right', 'cmd_up'), ['left', 'right', 'up']),
        (('motor_1', 'motor_2', 'motor_3'), ['motor_1', 'motor_2', 'motor_3']),
        (('motor_up', 'motor_forward'), ['motor_up', 'motor_forward']),
        (('thr_l', 'thr_r'), ['left', 'right']),
    ],
)
def test_places_and_numbers_of_commands_are_those_of_rotors(tmp_path, names, called):
    draft = draft_mapping(write_commands(tmp_path / 'a.csv', names), {})
    assert [*find_topic(draft, 'motors')['actuators']] == called


def test_three_commanded_coordinates_are_a_place_unless_the_user_says_otherwise(tmp_path):
    source = write_commands(tmp_path / 'a.csv', ('cmd_x', 'cmd_y', 'cmd_z'))
    assert find_topic(draft_mapping(source, {}), 'setpoint/pose') is not None
    answers = {f'cmd_{axis}.command': of for axis, of in
               zip('xyz', ('surge', 'sway', 'heave'), strict=True)}  # fmt: skip
    answers |= {f'{of}.largest': '0.1 N' for of in answers.values()}
    wrench = find_topic(draft_mapping(source, answers), 'wrench_command')
    assert wrench['force']['columns'] == ['cmd_x', 'cmd_y', 'cmd_z']


def test_small_numbers_can_be_shares_or_forces(tmp_path):
    source = write_commands(tmp_path / 'a.csv', SHARES, 0.1)
    (question,) = draft_mapping(source, {}, WHALE).choices.questions
    assert question.key == 'wrench_command.unit'


@pytest.mark.parametrize('names', [('surge_vel', 'heave_vel'), ('roll', 'pitch', 'yaw'),
                                   ('ref_surge', 'ref_heave')])  # fmt: skip
def test_motions_and_setpoints_are_no_commands_of_an_axis(tmp_path, names):
    draft = draft_mapping(write_commands(tmp_path / 'a.csv', names), {}, WHALE)
    assert find_topic(draft, 'wrench_command') is None


@pytest.mark.parametrize(
    ('names', 'called'),
    [
        (('Fl_series', 'Fr_series'), ['left', 'right']),
        (('fl', 'fr', 'rl', 'rr'), ['fl', 'fr', 'rl', 'rr']),
    ],
)
def test_the_forces_left_and_right_are_named_after_the_rotors(tmp_path, names, called):
    draft = draft_mapping(write_commands(tmp_path / 'a.csv', names, 0.1), {})
    assert [*find_topic(draft, 'motors')['actuators']] == called


def test_a_rotor_that_the_vehicle_file_calls_otherwise_is_asked(tmp_path):
    source = write_commands(tmp_path / 'a.csv', ('pwm_left', 'pwm_right', 'pwm_z'))
    (question,) = draft_mapping(source, {}, WHALE).choices.questions
    assert question.key == 'pwm_z.command'
    assert [name for name, _ in question.options] == ['left', 'right', 'up', 'none']
    draft = draft_mapping(source, {'pwm_z.command': 'up'}, WHALE)
    assert [*find_topic(draft, 'motors')['actuators']] == ['left', 'right', 'up']
    with pytest.raises(BadInput, match=r"Unknown rotor for pwm_z\.command 'top'"):
        draft_mapping(source, {'pwm_z.command': 'top'}, WHALE)


def write_bag(path, seconds=40.0, ahead=0):
    """
    Write a bag of ROS 1 with poses in mm and y up, and a stick that pushes forward and turns.

    The vehicle accelerates as its stick says, 0.1 s later. `ahead`: of the tracker's clock [ns].
    """
    types = get_typestore(Stores.ROS1_NOETIC)
    kind = types.types
    rng = np.random.default_rng(4)
    t = np.arange(0.0, seconds, 0.02)
    stick = np.repeat(rng.uniform(-1.0, 1.0, (len(t) // 100, 2)), 100, axis=0)
    late = np.concatenate([np.zeros((5, 2)), stick[:-5]])
    speed, rate, yaw, place = 0.0, 0.0, 0.0, np.zeros(3)
    up = Rotation.from_euler('x', -90.0, degrees=True)  # from z up to y up
    with Writer(path) as writer:
        one = writer.add_connection('/vrpn/blimp/pose', POSE, typestore=types)
        other = writer.add_connection('/blimp/cmd', ARRAY, typestore=types)
        for k, now in enumerate(t):
            speed += 0.02 * (0.3 * late[k, 0] - 0.4 * speed)
            rate += 0.02 * (0.5 * late[k, 1] - 0.3 * rate)
            yaw += 0.02 * rate
            place += 0.02 * speed * np.array([np.cos(yaw), np.sin(yaw), 0.0])
            turn = up * Rotation.from_euler('z', yaw) * up.inv()
            x, y, z = 1e3 * up.apply(place + np.array([0.0, 0.0, 1.5]))
            stamp = int((1e9 + now) * 1e9)
            head = kind['std_msgs/msg/Header'](
                k, kind['builtin_interfaces/msg/Time'](*divmod(stamp + ahead, 10**9)), 'world'
            )
            pose = kind['geometry_msgs/msg/Pose'](
                kind['geometry_msgs/msg/Point'](x, y, z),
                kind['geometry_msgs/msg/Quaternion'](*turn.as_quat()),
            )
            writer.write(one, stamp, types.serialize_ros1(kind[POSE](head, pose), POSE))
            numbers = np.array([*stick[k], 0.0], np.float32)
            layout = kind['std_msgs/msg/MultiArrayLayout']([], 0)
            message = kind[ARRAY](layout, numbers)
            writer.write(other, stamp + 1, types.serialize_ros1(message, ARRAY))
    return path


def test_a_bag_with_y_up_in_mm_and_a_stick(tmp_path):
    source = write_bag(tmp_path / 'a.bag')
    questions = {one.key: one for one in draft_mapping(source, {}).choices.questions}
    assert [*questions] == [f'data[{k}].command' for k in range(3)]
    # The third number is always 0 here, but perhaps not in another log
    assert 'explains' not in questions['data[2].command'].reason
    assert 'of the forward acceleration' in questions['data[0].command'].reason
    assert 'of the yaw acceleration' in questions['data[1].command'].reason
    answers = {'data[0].command': 'surge', 'data[1].command': 'yaw', 'data[2].command': 'none'}
    draft = draft_mapping(source, answers, WHALE)
    assert draft.choices.questions == []
    pose = find_topic(draft, 'ground_truth/odom')
    assert (pose['world'], pose['body'], pose['position']['unit']) == ('Y_UP', 'Y_UP', 'mm')
    assert find_topic(draft, 'wrench_command')['force']['columns'] == ['data[0]', None, None]
    assert {channel.name.split('.')[0] for channel in draft.channels} == {'position', 'quaternion'}


@pytest.mark.parametrize('vehicle', [None, WHALE])
def test_the_numbers_of_an_array_are_rotors_if_the_user_says_so(tmp_path, vehicle):
    source = write_bag(tmp_path / 'a.bag')
    answers = {'data[0].command': 'left', 'data[1].command': 'right', 'data[2].command': 'none'}
    motors = find_topic(draft_mapping(source, answers, vehicle), 'motors')['actuators']
    assert motors == {
        name: {'effort': {'column': f'data[{k}]'}} for k, name in enumerate(('left', 'right'))
    }
    draft = draft_mapping(source, {**answers, 'data[1].command': 'none'}, vehicle)
    assert [*find_topic(draft, 'motors')['actuators']] == ['left']


def write_plain_bag(path):
    """Write an odometry of OptiTrack, a pose without stamps, and the twist of a stick."""
    types = get_typestore(Stores.ROS2_JAZZY)
    kind = {name.rpartition('/')[2]: one for name, one in types.types.items()}
    rng = np.random.default_rng(6)
    turn, place = kind['Quaternion'](0.0, 0.0, 0.0, 1.0), kind['Point'](1.0, 2.0, 1.5)
    pose = kind['Pose'](place, turn)
    zero = kind['Vector3'](0.0, 0.0, 0.0)
    still = kind['TwistWithCovariance'](kind['Twist'](zero, zero), np.zeros(36))
    with Writer2(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        open_ = {}
        for k in range(60):
            x, z, r = rng.uniform(-1.0, 1.0, 3).tolist()
            head = kind['Header'](kind['Time'](100 + k, 0), 'world')
            twist = kind['Twist'](kind['Vector3'](x, 0.0, z), kind['Vector3'](0.0, 0.0, r))
            for topic, message in (
                ('/optitrack/odom', kind['Odometry'](
                    head, 'b', kind['PoseWithCovariance'](pose, np.zeros(36)), still)),
                ('/ekf/pose', pose),
                ('/cmd_vel', twist),
            ):  # fmt: skip
                name = message.__msgtype__
                if topic not in open_:
                    open_[topic] = writer.add_connection(topic, name, typestore=types)
                data = types.serialize_cdr(message, name)
                writer.write(open_[topic], (100 + k) * 10**9, data)
    return path


def test_a_twist_of_a_stick_is_a_wrench_and_a_tracker_is_no_estimate(tmp_path, bring):
    source = write_plain_bag(tmp_path / 'bag')
    draft = draft_mapping(source, {}, WHALE)
    assert draft.choices.questions == []
    tables = {one['topic']: one['table'] for one in yaml.safe_load(draft.text)['topics']}
    assert tables == {
        'ground_truth/odom': '/optitrack/odom', 'odom': '/ekf/pose', 'wrench_command': '/cmd_vel',
    }  # fmt: skip
    wrench = find_topic(draft, 'wrench_command')
    assert wrench['force']['columns'] == ['linear.x', None, 'linear.z']
    assert wrench['torque']['columns'] == [None, None, 'angular.z']
    got = bring(source, draft.text)
    assert got.messages['/lta1/odom'][0].pose.pose.position.z == 1.5


def test_poses_with_the_stamps_of_another_computer_get_the_times_of_the_log(tmp_path, bring):
    answers = {'data[0].command': 'surge', 'data[1].command': 'yaw', 'data[2].command': 'none'}
    source = write_bag(tmp_path / 'a.bag', ahead=37 * 10**9)
    draft = draft_mapping(source, answers, WHALE)
    assert find_topic(draft, 'ground_truth/odom')['stamps'] == 'log'
    assert 'stamps' not in find_topic(draft, 'wrench_command')
    got = bring(source, draft.text)
    first = [got.stamps(f'/lta1/{name}')[0] for name in ('ground_truth/odom', 'wrench_command')]
    assert abs(first[0] - first[1]) < 10**7
    # A delay of transport is none
    late = draft_mapping(write_bag(tmp_path / 'b.bag', ahead=-5 * 10**7), answers, WHALE)
    assert 'stamps' not in find_topic(late, 'ground_truth/odom')
