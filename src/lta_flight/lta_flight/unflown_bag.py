"""Remove the bag of a graph that ended before the flight began."""

from collections.abc import Iterable
from pathlib import Path
import shutil

from lta_config.errors import BadInput
from lta_data.bag.info import summarize_bag

GRAPH_TOPICS = ('/clock', '/diagnostics', '/parameter_events', '/rosout')  # also without a flight


def remove_unflown_bags(bags: Iterable[Path]) -> None:
    """Remove the bags that hold no message of a robot; the others stay."""
    for bag in bags:
        if bag.is_dir() and not has_flight(bag):
            shutil.rmtree(bag, ignore_errors=True)


def has_flight(bag: Path) -> bool:
    """Return whether a folder has anything but a readable bag without a message of a robot."""
    if not any(bag.iterdir()):
        return False
    try:
        topics = summarize_bag(bag).topics
    except BadInput:
        return True  # what is not understood is kept
    return any(topic.count for topic in topics if topic.name not in GRAPH_TOPICS)
