"""Select the topics to record: those marked in the topic table, topics by name, or all."""

from collections.abc import Mapping, Sequence

from lta_config.errors import unknown_name_error
from lta_config.topics import robot_topic, Topic, TopicTable

EVERYTHING = 'all'
ROS_OWN: Mapping[str, str] = {  # topics that every ROS node has, and their types
    '/parameter_events': 'rcl_interfaces/msg/ParameterEvent',
    '/rosout': 'rcl_interfaces/msg/Log',
}


def absolute_topic(robot: str, name: str) -> str:
    """Return the absolute name of a topic; the robot may have no namespace."""
    return robot_topic(robot, name) if robot else f'/{name.lstrip("/")}'


def is_selected(words: str, robot: str, name: str, topic: Topic) -> bool:
    """
    Return whether to record a topic of the table.

    Parameters
    ----------
    words : str
        Relative or absolute names separated by spaces; 'all'; or '' for those the table marks.
    robot : str
        Namespace of the robot.
    name : str
        Name in the table.
    topic : Topic
        Its row.

    """
    chosen = words.split()
    if not chosen:
        return topic.recorded
    return chosen == [EVERYTHING] or name in chosen or absolute_topic(robot, name) in chosen


def select_topics(words: str, robots: Sequence[str], table: TopicTable) -> dict[str, str]:
    """
    Return the types of the topics to record that are known in advance, by absolute name.

    `words`: as for `is_selected`. `robots`: namespaces of the robots to record. `table`: the
    topics of each. Raise `BadInput` if a name is neither a topic of the table nor one that every
    ROS node has.
    """
    rows = [(robot, *row) for robot in robots for row in table.topics.items()]
    named = {absolute_topic(robot, name): topic.type for robot, name, topic in rows} | dict(
        ROS_OWN
    )
    for word in words.split() if words.split() != [EVERYTHING] else []:
        if word not in named and word not in table.topics:
            raise unknown_name_error('topic', word, [*table.topics, *ROS_OWN, EVERYTHING])
    topics = [absolute_topic(row[0], row[1]) for row in rows if is_selected(words, *row)]
    # With 'all' these are discovered on the graph, like any other topic
    topics += [name for name in ROS_OWN if name in words.split()]
    return {name: named[name] for name in topics}
