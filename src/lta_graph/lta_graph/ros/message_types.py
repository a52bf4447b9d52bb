"""Look up the Python classes of the messages in the topic table."""

from importlib import import_module
from typing import Any

from lta_config.topics import Topic


def find_message_type(topic: Topic) -> Any:  # noqa: ANN401 - a generated class
    """Return the Python class of a topic's messages."""
    return getattr(import_module(f'{topic.package}.msg'), topic.message)
