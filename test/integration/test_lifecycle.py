# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A flight whose nodes are lifecycle nodes: they wait for `activate`, and work on in flight."""

from action_msgs.msg import GoalStatus
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from lta_msgs.action import Land, TakeOff
import pytest
from rclpy.action import ActionClient

from .peer import Peer

MANAGED = ('estimator', 'controller', 'navigator')


class Manager(Peer):
    """A lifecycle manager, and a client of the actions."""

    def change(self, name, transition):
        """Return whether a transition succeeded."""
        asked = Transition(id=transition)
        return self.ask(ChangeState, f'{name}/change_state', transition=asked).success

    def state(self, name):
        return self.ask(GetState, f'{name}/get_state').current_state.id

    def send(self, kind, name, goal):
        client = ActionClient(self.node, kind, name)
        self.until(client.server_is_ready)
        return self.wait(client.send_goal_async(goal))

    def wait(self, future):
        self.until(future.done)
        return future.result()


@pytest.mark.long
def test_nodes_wait_for_their_activation_and_work_on_in_flight(lta, scenario, domain_id):
    with Manager(domain_id) as manager:
        words = ('commanded:=true', 'autostart:=false', 'record:=false')
        launch = lta.start('launch', 'fly', *words, f'scenario:={scenario(walls="solid")}')
        for name in MANAGED:
            assert manager.state(name) == State.PRIMARY_STATE_UNCONFIGURED
            assert manager.change(name, Transition.TRANSITION_CONFIGURE)
        assert not manager.send(TakeOff, 'take_off', TakeOff.Goal(height=0.5)).accepted
        for name in MANAGED:
            assert manager.change(name, Transition.TRANSITION_ACTIVATE)
        while not (flight := manager.send(TakeOff, 'take_off', TakeOff.Goal(height=0.5))).accepted:
            pass
        assert manager.wait(flight.get_result_async()).status == GoalStatus.STATUS_SUCCEEDED
        for name in MANAGED:
            assert not manager.change(name, Transition.TRANSITION_DEACTIVATE)
            assert manager.state(name) == State.PRIMARY_STATE_ACTIVE
        # Nothing can refuse it, but the node works on
        assert manager.change('controller', Transition.TRANSITION_ACTIVE_SHUTDOWN)
        landed = manager.send(Land, 'land', Land.Goal())
        assert manager.wait(landed.get_result_async()).status == GoalStatus.STATUS_SUCCEEDED
        manager.until(lambda: manager.change('navigator', Transition.TRANSITION_DEACTIVATE))
        assert not manager.send(TakeOff, 'take_off', TakeOff.Goal(height=0.5)).accepted
    launch.interrupt()
    launch.end()
    assert launch.text.count('deactivate: the drone flies, so the node works on') == 3
    assert 'take_off is refused: the navigator is inactive' in launch.text
