# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A node whose callbacks keep their exceptions, for a process that runs several nodes."""

from collections.abc import Callable
from typing import Any, TypedDict, Unpack

from lta_graph.health import RejectionCount
from lta_graph.ros.message_validation import decode_message
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Timer


class NodeOptions(TypedDict, total=False):
    """Arguments of rclpy's Node that every node passes on to it."""

    namespace: str
    parameter_overrides: list[Parameter]
    cli_args: list[str]  # its own command line
    use_global_arguments: bool  # whether that of the process counts, too
    context: Context


class ContainedNode(Node):
    """
    A node whose callbacks raise nothing: an executor would not say whose exception it is.

    Attributes
    ----------
    fault : Exception or None
        What a callback has raised; no further one is called, and the process ends the node.
    undecodable : RejectionCount
        Received data that are no message of their topic, which are dropped.

    """

    def __init__(self, name: str, **options: Unpack[NodeOptions]) -> None:
        # rclpy's constructor creates services already
        self.fault: Exception | None = None
        self.undecodable = RejectionCount()
        super().__init__(name, **options)

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], None],
        *arguments: Any,
        raw: bool = False,
        **more: Any,
    ) -> Subscription:
        """
        Return a subscription as `rclpy.node.Node` does.

        Data that are no message are counted; rclpy itself would drop them without a word.
        """

        def receive_data(data: bytes) -> None:
            try:
                message = decode_message(data, msg_type)
            except ValueError as error:
                self.undecodable.add(f'{topic}: {error}')
            else:
                callback(message)

        receive = self.contain(callback if raw else receive_data)
        return super().create_subscription(msg_type, topic, receive, *arguments, raw=True, **more)

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], None],
        *arguments: Any,
        **more: Any,
    ) -> Timer:
        """Return a timer as `rclpy.node.Node` does."""
        return super().create_timer(timer_period_sec, self.contain(callback), *arguments, **more)

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        **more: Any,
    ) -> Service:
        """Return a service as `rclpy.node.Node` does."""
        serve = self.contain(callback)

        def answer(request: Any, response: Any) -> Any:
            return serve(request, response) or response

        return super().create_service(srv_type, srv_name, answer, **more)

    def contain(self, callback: Callable[..., Any]) -> Callable[..., Any]:
        """
        Return a callback whose exception becomes the `fault` of this node.

        An executor raises the exception of any of its nodes and does not say whose it is.
        """

        def call(*arguments: Any) -> Any:
            if self.fault is None:
                try:
                    return callback(*arguments)
                except Exception as error:
                    self.fault = error
            return None

        return call
