"""The topic table of `topics.yaml`, and the one rule for which message is due when."""

from collections.abc import Mapping
from functools import cache, cached_property
import re
from typing import Annotated, Literal

from lta_config.errors import unknown_name
from lta_config.files import load_file, share_folder, StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import AliasChoices, Field

Qos = Literal['sensor', 'command', 'default', 'latched', 'clock']


def to_nanoseconds(time: Quantity) -> int:
    """Return a time as integer nanoseconds."""
    return round(time.si * 1e9)


class Topic(StrictModel):
    """One row of the table; see the head of `topics.yaml` for the meaning of the columns."""

    type: Annotated[str, Field(pattern=r'^\w+/msg/\w+$')]
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

    @property
    def package(self) -> str:
        """The message's package, `sensor_msgs`."""
        return self.type.split('/')[0]

    @property
    def message(self) -> str:
        """The message's own name, `Imu`."""
        return self.type.split('/')[2]

    @cached_property
    def period_ns(self) -> int:
        """Time between two stamps; 0 where the topic has no rhythm. [ns]"""
        return 0 if self.period is None else to_nanoseconds(self.period)

    @cached_property
    def latency_ns(self) -> int:
        """Time from the stamp to the publication. [ns]"""
        return to_nanoseconds(self.latency)


class AdcBlockShape(StrictModel):
    """The shape of an ADC block."""

    sample_rate: Annotated[Quantity, si_quantity('Hz', above=0.0)]
    samples: Annotated[int, Field(ge=2)]


class TopicTable(StrictModel):
    """Every topic of the graph, with the times they share."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    start: Annotated[Quantity, si_quantity('s', above=0.0)]
    control_period: Annotated[Quantity, si_quantity('s', above=0.0)]
    light: AdcBlockShape
    topics: Mapping[str, Topic]

    def __getitem__(self, name: str) -> Topic:
        """Return one topic; an unknown name is a `BadInput` that lists the known ones."""
        if name not in self.topics:
            raise unknown_name('topic', name, list(self.topics))
        return self.topics[name]

    @cached_property
    def start_ns(self) -> int:
        """The first stamp of a simulated flight. [ns]"""
        return to_nanoseconds(self.start)

    @cached_property
    def control_ns(self) -> int:
        """The control period. [ns]"""
        return to_nanoseconds(self.control_period)

    def published_by(self, role: str) -> list[str]:
        """Return the topics that a role publishes."""
        return [name for name, topic in self.topics.items() if topic.source == role]

    def read_by(self, role: str) -> list[str]:
        """Return the topics that a role must wait for."""
        return [name for name, topic in self.topics.items() if role in topic.subscribers]

    def trigger_topic(self, role: str) -> str:
        """Return the topic that a role answers message by message; empty where it answers none."""
        return next((self[name].answers for name in self.published_by(role)), '')

    def count_due(self, name: str, now_ns: int, lag: int = 0) -> int:
        """
        Return how many messages of a topic are out at a control step.

        Parameters
        ----------
        name : str
            A periodic topic.
        now_ns : int
            Stamp of the control step. [ns]
        lag : int
            Control periods by which the reader lags behind the publication.

        """
        topic = self[name]
        newest = now_ns - topic.latency_ns - lag * self.control_ns - self.start_ns
        return max(0, newest // topic.period_ns + 1)

    def is_settled(self, now_ns: int) -> bool:
        """Tell whether a control step is the one after a light block: all is answered then."""
        since = now_ns - self.start_ns - self.control_ns
        return since % self['photodiodes'].period_ns == 0


def robot_topic(robot: str, name: str) -> str:
    """Return the absolute name of a topic of one robot: `/lta1/odom`, but `/clock`."""
    return name if name.startswith('/') else f'/{robot}/{name}'


def is_name(text: str) -> bool:
    """Tell whether a text can be a robot's namespace or a node's name in ROS."""
    return re.fullmatch(r'[A-Za-z][A-Za-z0-9_]*', text) is not None


@cache
def load_topic_table() -> TopicTable:
    """Return the table that LTA ships."""
    return load_file(TopicTable, share_folder() / 'topics.yaml')
