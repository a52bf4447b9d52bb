"""A message that is copied from a blank one is a new message, and shares nothing with others."""

from lta_config.topics import load_topic_table
from lta_graph.blank_message import create_message
from lta_graph.ros.message_validation import find_message_type
from nav_msgs.msg import Odometry
import pytest

TYPES = sorted({find_message_type(topic) for topic in load_topic_table().topics.values()}, key=str)


@pytest.mark.parametrize('kind', TYPES, ids=lambda kind: kind.__name__)
def test_it_is_what_the_class_creates(kind):
    assert type(create_message(kind)) is kind
    assert str(create_message(kind)) == str(kind())


def test_two_share_nothing():
    one = create_message(Odometry)
    one.header.stamp.sec = 7
    one.pose.covariance[0] = 2.0
    one.pose.pose.position.x = 1.0
    assert str(create_message(Odometry)) == str(Odometry())
