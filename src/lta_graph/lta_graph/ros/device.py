"""A node that holds a device, which it gives back on every way out but SIGKILL."""

from lta_config.errors import BadInput
from lta_graph.ros.node import GraphNode
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn


class DeviceNode(LifecycleNodeMixin, GraphNode):
    """
    A lifecycle node that plays the vehicle, or a part of it, with real hardware.

    A subclass opens its link in `on_configure` and gives it back in `release_device`.

    Parameters
    ----------
    name : str
        Of the node.
    device : str
        What it holds, in words.

    Attributes
    ----------
    active : bool
        Whether the state is active.
    autostart : bool
        Whether to configure and activate by itself; off until a subclass says otherwise.
    refusal : str
        Why it could not be configured, for whoever started it.

    Raises
    ------
    BadInput
        In lockstep, which no hardware keeps. In `run`, what refused to be configured.

    """

    def __init__(self, name: str, device: str) -> None:
        GraphNode.__init__(self, name, role='vehicle')
        LifecycleNodeMixin.__init__(self)
        if self.lockstep:
            raise BadInput(f'A real {device} keeps real time: leave time:=lockstep out.')
        self.active, self.autostart, self.refusal = False, False, ''

    def run(self) -> None:
        """Start by itself where that is wanted, and work."""
        if self.autostart:
            if self.trigger_configure() != TransitionCallbackReturn.SUCCESS:
                raise BadInput(self.refusal)
            self.trigger_activate()
        super().run()

    def release_device(self) -> None:
        """Give the device back, in a safe state; again is harmless."""
        raise NotImplementedError

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Work from now on."""
        self.active = True
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Keep the link, and do nothing."""
        self.active = False
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Give the device back."""
        self.release_device()
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Give the device back, whatever the state was."""
        self.release_device()
        return super().on_shutdown(state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Give the device back: a transition has failed."""
        self.release_device()
        return super().on_error(state)

    def close(self) -> None:
        """Give the device back, then leave the graph."""
        self.release_device()
        super().close()
