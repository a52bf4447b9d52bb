"""Who is run again in a replay, whose recorded messages are played, and what is then missing."""

from collections.abc import Collection, Sequence
from typing import final, NamedTuple

from lta_config.errors import BadInput, unknown_name
from lta_config.topics import TopicTable

VEHICLE = 'vehicle'
CLOCK = '/clock'  # told by the player, not played


@final
class NodeSelection(NamedTuple):
    """
    The parts of a replay.

    Attributes
    ----------
    nodes : tuple of str
        Roles that are run again.
    played : tuple of str
        Topics that come from the recording.
    answers : tuple of str
        Topics that come from the nodes.

    """

    nodes: tuple[str, ...]
    played: tuple[str, ...]
    answers: tuple[str, ...]

    def find_missing_topics(self, table: TopicTable, recorded: Collection[str]) -> list[str]:
        """Return the topics that the nodes read and nobody sends."""
        there = {*self.answers, *(name for name in self.played if name in recorded)}
        read = {name for node in self.nodes for name in table.read_by(node)}
        return [name for name in table.topics if name in read - there]


def list_answering_roles(table: TopicTable) -> list[str]:
    """Return the roles that can be run again: those that answer a topic."""
    sources = dict.fromkeys(topic.source for topic in table.topics.values())
    return [role for role in sources if table.trigger_topic(role)]


def select_nodes(table: TopicTable, nodes: Sequence[str], also: Sequence[str]) -> NodeSelection:
    """
    Return the parts of a replay.

    Parameters
    ----------
    table : TopicTable
        Who sends and reads what.
    nodes : sequence of str
        Roles to run again; all where empty.
    also : sequence of str
        Roles whose recorded messages are played, besides the vehicle's.

    Raises
    ------
    BadInput
        If a role is unknown, or would be both run and played.

    """
    known = list_answering_roles(table)
    for name in (*nodes, *also):
        if name not in known:
            raise unknown_name('node', name, known)
    again = tuple(nodes) or tuple(known)
    for name in also:
        if name in again:
            raise BadInput(f"'{name}' would be played and run again; leave it out of one.")
    played = [name for role in (VEHICLE, *also) for name in table.published_by(role)]
    return NodeSelection(
        again,
        tuple(name for name in played if name != CLOCK),
        tuple(name for role in again for name in table.published_by(role)),
    )


def list_supporting_roles(table: TopicTable, nodes: Sequence[str]) -> list[str]:
    """Return the roles, besides the vehicle, whose messages some nodes read and do not send."""
    sources = {table[name].source for node in nodes for name in table.read_by(node)}
    return [role for role in list_answering_roles(table) if role in sources - set(nodes)]
