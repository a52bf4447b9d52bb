# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A flight by actions, commanded by a plain rclpy client over DDS."""

from collections.abc import Iterator
import json
import math

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Pose, PoseStamped
from lta_msgs.action import FollowPath, GoToLamp, GoToPose, Land, TakeOff
import pytest
from rcl_interfaces.msg import Log
from rclpy.action import ActionClient
from rclpy.qos import qos_profile_sensor_data

from .command import ROOT
from .peer import Peer

COMMANDED = ('launch', 'fly', 'commanded:=true', 'strategy:=homing', 'record:=false')


class Commander:
    """A client of the three actions."""

    def __init__(self, peer: Peer) -> None:
        self.peer = peer
        kinds = {
            'take_off': TakeOff,
            'go_to_lamp': GoToLamp,
            'go_to_pose': GoToPose,
            'follow_path': FollowPath,
            'land': Land,
        }
        self._clients = {n: ActionClient(peer.node, kind, n) for n, kind in kinds.items()}
        self.feedback: list[object] = []
        self.logged: list[Log] = []
        peer.node.create_subscription(Log, '/rosout', self.logged.append, 1000)

    def wait(self, future):
        """Return the result of a future."""
        self.peer.until(future.done)
        return future.result()

    def send(self, name, goal):
        """Send a goal and return its handle; its feedback replaces that of the last one."""
        self.peer.until(self._clients[name].server_is_ready)
        self.feedback = mine = []
        sent = self._clients[name].send_goal_async(
            goal, feedback_callback=lambda message: mine.append(message.feedback)
        )
        return self.wait(sent)

    def fly(self, name, goal):
        """Send a goal and return status and result at its end."""
        ended = self.wait(self.send(name, goal).get_result_async())
        return ended.status, ended.result

    def refuse(self, name, goal, why):
        """Send a goal that is refused, and wait until the navigator has logged the reason."""
        before = len(self.logged)
        assert not self.send(name, goal).accepted
        line = f'{name} is refused: {why}'
        self.peer.until(lambda: any(each.msg == line for each in self.logged[before:]))

    def take_off(self, height):
        """Take off as soon as the estimator is ready."""
        while not (handle := self.send('take_off', TakeOff.Goal(height=height))).accepted:
            pass
        ended = self.wait(handle.get_result_async())
        return ended.status, ended.result


@pytest.fixture
def commander(domain_id) -> Iterator[Commander]:
    with Peer(domain_id) as peer:
        yield Commander(peer)


@pytest.mark.parametrize(
    ('mode', 'processes'),
    [
        ('lockstep', 'many'),
        pytest.param('lockstep', 'one', marks=pytest.mark.long),
        pytest.param('realtime', 'many', marks=pytest.mark.long),
    ],
)
def test_a_client_takes_off_goes_to_the_lamp_and_lands(lta, scenario, commander, mode, processes):
    room = scenario(walls='solid', time_limit='1 s')  # which does not end a commanded flight
    words = (f'time:={mode}', f'processes:={processes}', f'scenario:={room}')
    launch = lta.start(*COMMANDED, *words)
    status, result = commander.take_off(0.6)
    assert (status, result.outcome) == (GoalStatus.STATUS_SUCCEEDED, TakeOff.Result.SUCCEEDED)
    assert result.message == 'the height is reached'
    assert 0.56 < result.height < 0.8
    assert commander.feedback[0].height < commander.feedback[-1].height
    assert max(each.climb_rate for each in commander.feedback) > 0.02

    commander.refuse('take_off', TakeOff.Goal(), 'the drone flies already')

    # Canceled on the way, after a second goal was refused
    handle = commander.send('go_to_lamp', GoToLamp.Goal())
    ended = handle.get_result_async()
    mine = commander.feedback
    commander.peer.until(lambda: any(each.seen for each in mine))
    busy = 'go_to_lamp is in progress; cancel it first'
    commander.refuse('go_to_lamp', GoToLamp.Goal(), busy)
    assert len(commander.wait(handle.cancel_goal_async()).goals_canceling) == 1
    ended = commander.wait(ended)
    assert ended.status == GoalStatus.STATUS_CANCELED
    assert ended.result.outcome == GoToLamp.Result.CANCELED
    assert ended.result.message == 'canceled'

    status, result = commander.fly('go_to_lamp', GoToLamp.Goal(frequency=150.0))
    assert (status, result.outcome) == (GoalStatus.STATUS_SUCCEEDED, GoToLamp.Result.SUCCEEDED)
    assert result.distance < 1.6  # twice the arrival distance
    seen = next(each for each in commander.feedback if each.distance > 0.0)
    assert 3.0 < seen.distance < 12.0  # it starts 7 m away
    assert abs(seen.bearing) <= math.pi

    status, result = commander.fly('land', Land.Goal())
    assert (status, result.outcome) == (GoalStatus.STATUS_SUCCEEDED, Land.Result.SUCCEEDED)
    assert result.message == 'the drone stands on the ground'
    assert commander.feedback[-1].height < commander.feedback[0].height

    commander.refuse('land', Land.Goal(), 'the drone does not fly')
    launch.interrupt()
    launch.end()
    (line,) = [line for _, line in launch.lines if '"outcome"' in line]
    assert json.loads(line.partition(' ')[2])['outcome'] == 'landed'


def at(x, y):
    pose = Pose()
    pose.position.x, pose.position.y = x, y
    return pose


def to_pose(x, y, tolerance=1.0, frame='map'):
    goal = GoToPose.Goal(pose=PoseStamped(pose=at(x, y)), tolerance=tolerance)
    goal.pose.header.frame_id = frame
    return goal


def test_a_tracked_drone_flies_to_places_until_its_tracker_is_lost(lta, scenario, commander, hear):
    """The poses of the simulated drone come by motion capture, which ends in flight."""
    room = scenario(walls='solid')  # 10 m x 8 m; the drone starts at -3.5, 0
    words = ('processes:=one', f'scenario:={room}', 'tracker:=true', 'tracker_pose:=tracker/pose')
    launch = lta.start(*COMMANDED, *words)
    peer, sees = commander.peer, True
    mocap = peer.node.create_publisher(PoseStamped, 'tracker/pose', qos_profile_sensor_data)

    def relay(odom):
        tick = odom.header.stamp.nanosec // 10_000_000
        if sees and tick % 4 == 0:  # 25 Hz
            # The noise of a camera, without which a pose counts as frozen
            odom.pose.pose.position.z += 0.0005 * (tick // 4 % 2)
            mocap.publish(PoseStamped(header=odom.header, pose=odom.pose.pose))

    peer.hear('ground_truth/odom', relay)
    assert commander.take_off(0.6)[0] == GoalStatus.STATUS_SUCCEEDED

    room_words = '10 m x 8 m around the origin'
    outside = f'the place 5.5, 0 m lies outside the room, {room_words}'
    commander.refuse('go_to_pose', to_pose(5.5, 0.0), outside)
    commander.refuse('go_to_pose', to_pose(math.nan, 0.0), 'the place nan, 0, 0 m is not finite')
    odom = "The frame of a place is map, not 'odom'."
    commander.refuse('go_to_pose', to_pose(0.0, 0.0, frame='odom'), odom)
    commander.refuse('follow_path', FollowPath.Goal(), 'there is no place to fly to')

    path = FollowPath.Goal(tolerance=1.0)
    path.path.poses = [at(-3.0, 0.0), at(-2.0, 0.0)]
    status, result = commander.fly('follow_path', path)
    assert status == GoalStatus.STATUS_SUCCEEDED, result.message
    assert result.outcome == FollowPath.Result.SUCCEEDED
    assert result.place == 1
    assert result.distance < 1.0
    assert [each.place for each in commander.feedback] == sorted(
        each.place for each in commander.feedback
    )

    handle = commander.send('go_to_pose', to_pose(2.0, 0.0))
    mine = commander.feedback
    peer.until(lambda: mine)
    assert 3.0 < mine[0].distance < 5.1  # 4 m and what it was off
    sees = False
    ended = commander.wait(handle.get_result_async())
    assert (ended.status, ended.result.outcome) == (
        GoalStatus.STATUS_ABORTED,
        GoToPose.Result.FAULT,
    )
    assert ended.result.message == 'the tracker is lost; holding height and heading'
    commander.refuse('go_to_pose', to_pose(2.0, 0.0), 'no tracker sees the drone')
    lost = 'lost: holding height and heading only'
    hear(lambda facts: (fact := facts.get('navigator: tracker')) and fact.message == lost)
    status, _ = commander.fly('land', Land.Goal())
    assert status == GoalStatus.STATUS_SUCCEEDED
    launch.interrupt()
    launch.end()


@pytest.mark.long
def test_the_example_flies_and_its_drone_outlives_it(lta, scenario, tmp_path):
    launch = lta.start(*COMMANDED, f'scenario:={scenario(walls="solid")}')
    words = ('--ros-args', '-r', '__ns:=/lta1')
    client = lta.start('run', ROOT / 'examples/own_commander.py', *words)
    assert client.end() == 0, client.text
    assert 'land: outcome 0, the drone stands on the ground' in client.text
    launch.interrupt()
    launch.end()


def test_a_strategy_that_never_arrives_is_refused(lta):
    result = lta.run('launch', 'fly', 'commanded:=true', 'strategy:=bag', 'record:=false')
    assert result.returncode == 2
    assert 'never reports an arrival at a lamp' in result.stderr
    assert 'Traceback' not in result.stderr
