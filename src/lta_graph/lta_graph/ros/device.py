# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A lifecycle node that owns a device and releases it on every exit except SIGKILL."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Unpack

from lta_config.errors import BadInput
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from rcl_interfaces.msg import SetParametersResult
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.time_source import USE_SIM_TIME_NAME


class DeviceNode(LifecycleNodeMixin, GraphNode, ABC):
    """
    A lifecycle node that plays the vehicle, or a part of it, with real hardware.

    A subclass opens its link in `on_configure` and closes it in `release_device`.

    Parameters
    ----------
    device : str
        The device in words, for error messages.

    Attributes
    ----------
    active : bool
        Whether the state is active.
    autostart : bool
        Whether `run` configures and activates the node; False unless a subclass sets it.
    refusal : str
        Why the last configuration failed.

    Raises
    ------
    BadInput
        In lockstep, which hardware cannot follow. From `run`, if the configuration fails.

    """

    def __init__(self, name: str, device: str, **options: Unpack[NodeOptions]) -> None:
        # Explicit calls: the mixin's constructor does not call the next one in the MRO
        GraphNode.__init__(self, name, role='vehicle', **options)
        LifecycleNodeMixin.__init__(self)
        if self.lockstep:
            raise BadInput(f'A real {device} works only in real time; remove time:=lockstep.')
        self.active, self.autostart, self.refusal = False, False, ''
        # rclpy asks the newest callback first, so its own has not switched the clock yet
        self.add_on_set_parameters_callback(self._refuse_simulated_time)

    def run(self) -> Iterator[None]:
        """Configure and activate if `autostart` is set, then spin."""
        if self.autostart:
            if self.trigger_configure() != TransitionCallbackReturn.SUCCESS:
                raise BadInput(self.refusal)
            self.trigger_activate()
        yield from super().run()

    def _refuse_simulated_time(self, parameters: list[Parameter]) -> SetParametersResult:
        if any(each.name == USE_SIM_TIME_NAME and each.value for each in parameters):
            why = 'real hardware follows the wall clock; leave use_sim_time false'
            return SetParametersResult(successful=False, reason=why)
        return SetParametersResult(successful=True)

    @abstractmethod
    def release_device(self) -> None:
        """Release the device in a safe state; safe to call again."""

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Set `active`."""
        self.active = True
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Clear `active`; the link stays open."""
        self.active = False
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release the device."""
        self.release_device()
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release the device from any state."""
        self.release_device()
        return super().on_shutdown(state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release the device after a failed transition."""
        self.release_device()
        return super().on_error(state)

    def close(self) -> None:
        """Release the device, then leave the graph."""
        # First, because leaving the graph waits for acknowledgements while motors may still turn
        self.release_device()
        super().close()
