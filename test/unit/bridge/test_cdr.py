# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages of rclpy in a bag: what rosbags writes is read by ROS, and written as it was by us."""

from lta_bridge.bag.schemas import encode_message
from lta_graph.ros.message_validation import decode_message
from lta_graph.ros.raw_subscriptions import load_message_class
import numpy as np
import pytest


def test_every_type_survives_the_way_there_and_back(graph_type, random_message):
    rng = np.random.default_rng(4)
    for _ in range(5):
        _, data = random_message(graph_type, rng)
        message = decode_message(data, load_message_class(graph_type))
        whole = -(-len(data) // 4) * 4  # the middleware's writer fills the last word
        assert encode_message(message, graph_type) == data.ljust(whole, b'\0')


def test_what_is_cut_short_is_refused(graph_type, random_message):
    """The middleware's reader passes some that end within a sequence of sequences, later on."""
    _, data = random_message(graph_type, np.random.default_rng(5))
    kind = load_message_class(graph_type)
    for size in range(0, len(data) // 2, 7):
        with pytest.raises(ValueError, match=kind.__name__):
            decode_message(data[:size], kind)
