"""
Whose setpoints count: the navigator's, or those of a person who has taken over.

A person has the helm until they hand it back. One who falls silent keeps it: their last word ages,
and whoever flies by it holds and lands, where the navigator's would have flown on unseen.
"""

from collections.abc import Callable
from typing import Any, Final, final

from lta_graph.health import HealthLevel
from lta_graph.ros.node import GraphNode

HELM: Final = 'helm'  # the task in which whoever flies by setpoints tells whose count
HELD: Final = 'held'  # there: whether a person's


@final
class CommandMux:
    """
    Listen to the person at the helm, if there is one.

    Parameters
    ----------
    node : GraphNode
        Whoever flies by setpoints. In lockstep there is no person.
    then : callable
        Called at each new word of the person.

    Attributes
    ----------
    held : bool
        Whether a person has the helm.

    """

    def __init__(self, node: GraphNode, then: Callable[[], None] = lambda: None) -> None:
        self.held = False
        self._node = node
        self._pose: Any = None
        self._velocity: Any = None
        self._then = then
        if node.lockstep:
            return
        self._report_source()
        # What is made last is taken first: a word is there before the helm changes hands.
        for name, callback in (
            ('teleop/held', self._on_takeover),
            ('teleop/velocity', self._on_velocity),
            ('teleop/pose', self._on_pose),
        ):
            node.subscribe_topic(name, callback)

    def select_setpoint(self, pose: Any, velocity: Any) -> tuple[Any, Any]:  # noqa: ANN401 - messages
        """Return the pose and velocity that count; the person's in place of the navigator's."""
        return (self._pose, self._velocity) if self.held else (pose, velocity)

    def _on_takeover(self, held: Any) -> None:  # noqa: ANN401 - a message
        if held.data != self.held:
            self.held = held.data
            self._report_source()
            self._node.publish_health()  # at once: a teleop that starts now must know

    def _report_source(self) -> None:
        whose = 'of a person' if self.held else 'of the navigator'
        self._node.health.report(
            HELM, HealthLevel.OK, f'by setpoints {whose}', **{HELD: self.held}
        )

    def _on_pose(self, pose: Any) -> None:  # noqa: ANN401 - a message
        self._pose = pose

    def _on_velocity(self, velocity: Any) -> None:  # noqa: ANN401 - a message
        self._velocity = velocity
        self._then()
