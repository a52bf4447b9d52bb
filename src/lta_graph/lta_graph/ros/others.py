"""Who else publishes what a node does: one topic of two minds steers nobody well."""

from collections.abc import Mapping

from rclpy.node import Node
from rclpy.publisher import Publisher

OTHERS = 'others'  # the task in which a node tells it
COMMON = '/diagnostics'  # of every node


def others(node: Node, writers: Mapping[str, Publisher]) -> str:
    """
    Return a sentence without a full stop on who else publishes the same; empty for nobody.

    Parameters
    ----------
    node : Node
        Whose outputs they are.
    writers : mapping of str to Publisher
        Its outputs, by what they are called.

    """
    shared = [
        name
        for name, writer in writers.items()
        if name != COMMON and node.count_publishers(writer.topic_name) > 1
    ]
    if not shared:
        return ''
    own, strangers = node.get_fully_qualified_name(), set[str]()
    for name in shared:
        known = node.get_publishers_info_by_topic(writers[name].topic_name)
        names = [f'{each.node_namespace.rstrip("/")}/{each.node_name}' for each in known]
        if own in names:
            names.remove(own)  # once: a namesake is another
        strangers.update(names)
    who = ', '.join(sorted(strangers)) or 'not yet known'
    return f'published by others too: {", ".join(shared)} ({who}); stop all but one'
