# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The topic table of `topics.yaml`: which messages are due when, and which are recorded."""

from collections.abc import Mapping, Sequence
from functools import cache, cached_property
import re
from typing import Annotated, Final, Literal

from lta_config.errors import unknown_name_error
from lta_config.files import load_file, SchemaVersion, share_folder, StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import AliasChoices, Field

Qos = Literal['sensor', 'command', 'default', 'latched', 'clock']
TYPE_NAME: Final = r'^\w+/msg/\w+$'


def to_nanoseconds(time: Quantity) -> int:
    """Return a time as integer nanoseconds."""
    return round(time.si * 1e9)


class Topic(StrictModel):
    """One row of the table; the head of `topics.yaml` explains the columns."""

    type: Annotated[str, Field(pattern=TYPE_NAME)]  # 'sensor_msgs/msg/Imu'
    unit: str
    frame: str
    qos: Qos
    about: str
    source: Annotated[str, Field(validation_alias=AliasChoices('from'))]
    subscribers: Annotated[Mapping[str, int], Field(validation_alias=AliasChoices('to'))]
    period: Annotated[Quantity, si_quantity('s', above=0.0)] | None = None
    latency: Annotated[Quantity, si_quantity('s', low=0.0)] = Quantity(value=0.0, unit='s')
    answers: str = ''
    stamped: bool = True
    recorded: bool = True
    repeatable: bool = True

    @cached_property
    def period_ns(self) -> int:
        """Time between two stamps; 0 for an aperiodic topic [ns]."""
        return 0 if self.period is None else to_nanoseconds(self.period)

    @cached_property
    def latency_ns(self) -> int:
        """Time from the stamp to the publication [ns]."""
        return to_nanoseconds(self.latency)


class AdcBlockShape(StrictModel):
    """The shape of an ADC block."""

    sample_rate: Annotated[Quantity, si_quantity('Hz', above=0.0)]
    samples: Annotated[int, Field(ge=2)]


class TopicTable(StrictModel):
    """All topics of the graph, and the times that they share."""

    schema_version: SchemaVersion
    start: Annotated[Quantity, si_quantity('s', above=0.0)]
    control_period: Annotated[Quantity, si_quantity('s', above=0.0)]
    light: AdcBlockShape
    topics: Mapping[str, Topic]

    def __getitem__(self, name: str) -> Topic:
        """Return one topic; an unknown name is a `BadInput` that lists the known ones."""
        if name not in self.topics:
            raise unknown_name_error('topic', name, list(self.topics))
        return self.topics[name]

    def with_start(self, seconds: float) -> 'TopicTable':
        """Return the table of a flight whose first stamp is another one [s]."""
        # Constructed anew: a copy would keep the cached times
        values = {name: getattr(self, name) for name in type(self).model_fields}
        start = Quantity(value=seconds, unit='s')
        return TopicTable.model_construct(**(values | {'start': start}))

    @cached_property
    def start_ns(self) -> int:
        """Return the first stamp of a simulated flight [ns]."""
        return to_nanoseconds(self.start)

    @cached_property
    def control_ns(self) -> int:
        """Return the control period [ns]."""
        return to_nanoseconds(self.control_period)

    @cached_property
    def roles(self) -> list[str]:
        """Return the roles that publish or must be waited for, in alphabetical order."""
        periodic = [topic for topic in self.topics.values() if topic.period_ns]
        sources = {topic.source for topic in periodic}
        return sorted(sources.union(*(topic.subscribers for topic in periodic)))

    def published_by(self, role: str) -> list[str]:
        """Return the topics that a role publishes."""
        return [name for name, topic in self.topics.items() if topic.source == role]

    def read_by(self, role: str) -> list[str]:
        """Return the topics that a role must wait for."""
        return [name for name, topic in self.topics.items() if role in topic.subscribers]

    def trigger_topic(self, role: str) -> str:
        """Return the topic whose messages trigger a role's outputs; empty if there is none."""
        return next((self[name].answers for name in self.published_by(role)), '')

    def count_due(self, name: str, now_ns: int, lag: int = 0) -> int:
        """
        Return how many messages of a topic have been published by a control step.

        `name`: a periodic topic. `now_ns`: stamp of the control step [ns]. `lag`: control periods
        by which the reader lags behind the publication.
        """
        topic = self[name]
        newest = now_ns - topic.latency_ns - lag * self.control_ns - self.start_ns
        # The first message is stamped start_ns, so 1 is due as soon as `newest` is 0
        return max(0, newest // topic.period_ns + 1)

    def is_settled(self, now_ns: int) -> bool:
        """Return whether a control step follows a light block, when all answers are complete."""
        # One control step is the time in which the block is processed
        since = now_ns - self.start_ns - self.control_ns
        return since % self['photodiodes'].period_ns == 0


def robot_topic(robot: str, name: str) -> str:
    """Return the absolute name of a robot's topic: `/lta1/odom`; `/clock` stays as it is."""
    return name if name.startswith('/') else f'/{robot}/{name}'


def is_name(text: str) -> bool:
    """Return whether a text is a valid namespace or node name in ROS."""
    # ROS also allows a leading underscore, but such names are hidden
    return re.fullmatch(r'[A-Za-z][A-Za-z0-9_]*', text) is not None


@cache
def load_topic_table() -> TopicTable:
    """Return the table that LTA ships."""
    return load_file(TopicTable, share_folder() / 'topics.yaml')


ALL_TOPICS = 'all'
ROS_TOPICS: Mapping[str, str] = {  # topics that every ROS node has, and their types
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
    return chosen == [ALL_TOPICS] or name in chosen or absolute_topic(robot, name) in chosen


def select_topics(words: str, robots: Sequence[str], table: TopicTable) -> dict[str, str]:
    """
    Return the types of the topics to record that are known in advance, by absolute name.

    `words`: as for `is_selected`. `robots`: namespaces of the robots to record. `table`: the
    topics of each. Raise `BadInput` if a name is neither a topic of the table nor one that every
    ROS node has.
    """
    rows = [(robot, *row) for robot in robots for row in table.topics.items()]
    named = {absolute_topic(robot, name): topic.type for robot, name, topic in rows} | dict(
        ROS_TOPICS
    )
    for word in words.split() if words.split() != [ALL_TOPICS] else []:
        if word not in named and word not in table.topics:
            raise unknown_name_error('topic', word, [*table.topics, *ROS_TOPICS, ALL_TOPICS])
    topics = [absolute_topic(row[0], row[1]) for row in rows if is_selected(words, *row)]
    # With 'all' these are discovered on the graph, like any other topic
    topics += [name for name in ROS_TOPICS if name in words.split()]
    return {name: named[name] for name in topics}
