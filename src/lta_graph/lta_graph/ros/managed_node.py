# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A node that a launch may manage by its lifecycle, and that nobody takes from a flight."""

from collections.abc import Callable
from typing import Unpack

from geometry_msgs.msg import PoseStamped
from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_graph.health import HealthLevel
from lta_graph.lockstep import InboxStep
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_msgs.msg import ActuatorDuty
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn


class LifecycleSettings(Settings):
    """Who starts the node."""

    autostart: bool = setting(True, fixed=True)
    """
    Whether the node works from its start. False: it is a lifecycle node, and works while active;
    in real time only.
    """


class ManagedNode(LifecycleNodeMixin, GraphNode):
    """
    A node whose steps run while it is active, which with `autostart` is always.

    To a drone in flight an inactive node is as a dead one. So while motors turn, or a setpoint is
    above the floor, `deactivate` fails, and `shutdown` lets the node go on.
    """

    def __init__(self, name: str, **options: Unpack[NodeOptions]) -> None:
        # Explicit calls: the mixin's constructor does not call the next one in the MRO
        GraphNode.__init__(self, name, **options)
        managed = not NodeParameters(self, LifecycleSettings).value.autostart
        if managed and self.lockstep:
            raise BadInput('A lifecycle is managed only in real time; remove time:=lockstep.')
        LifecycleNodeMixin.__init__(self, enable_communication_interface=managed)
        self.active = not managed
        self._turns = self._rises = False  # whether motors turn, and a setpoint is above the floor
        if managed:
            self.subscribe_topic('motors', self._on_newest_motors)
            self.subscribe_topic('setpoint/pose', self._on_newest_setpoint)

    def _on_newest_motors(self, motors: ActuatorDuty) -> None:
        self._turns = any(motors.duty)

    def _on_newest_setpoint(self, setpoint: PoseStamped) -> None:
        self._rises = setpoint.pose.position.z > 0.0

    def subscribe_inputs(
        self,
        topics: list[str],
        trigger: str,
        on_step: Callable[[InboxStep], None],
        prefix: str = '',
    ) -> None:
        """Subscribe as `GraphNode` does; an inactive node drops its steps."""

        def run_step(step: InboxStep) -> None:
            if self.active:
                on_step(step)

        super().subscribe_inputs(topics, trigger, run_step, prefix)

    def update_health(self) -> None:
        """Report whether the node works."""
        if not self.active:
            self.health.report('lifecycle', HealthLevel.WARN, 'inactive: activate the node')
        elif 'lifecycle' in self.health:
            self.health.report('lifecycle', HealthLevel.OK, 'active')

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Work from now on."""
        self.active = True
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Rest, unless the drone flies."""
        if self._refuses_rest('deactivate'):
            return TransitionCallbackReturn.FAILURE
        return super().on_deactivate(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Rest for good, unless the drone flies: nothing can refuse this transition."""
        self._refuses_rest('shutdown')
        return super().on_shutdown(state)

    def _refuses_rest(self, transition: str) -> bool:
        flies = self._turns or self._rises
        self.active = self.active and flies
        if flies:
            self.get_logger().error(f'{transition}: the drone flies, so the node works on')
        return flies
