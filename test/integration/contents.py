"""What a bag holds, by somebody else's reader: to compare flights byte for byte."""

from collections import defaultdict
from pathlib import Path

from rosbags.highlevel import AnyReader


def contents(bag: Path) -> dict[str, list[tuple[int, bytes]]]:
    """Return log times and bytes by topic, as the genuine rosbags library reads them."""
    found = defaultdict(list)
    with AnyReader([bag]) as reader:
        for connection, log_time, data in reader.messages():
            found[connection.topic].append((log_time, bytes(data)))
    return found
