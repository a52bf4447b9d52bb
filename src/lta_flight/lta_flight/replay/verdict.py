"""Whether a replay is the recording: to the last bit, as near as machines get, or not."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final, Literal

from lta_bridge.provenance import here
from lta_config.errors import BadInput
from lta_config.topics import robot_topic, topic_table
from lta_data.bag.flight import Flight
from lta_flight.replay.against import Compared, compared, elsewhere, TOLERANCE
from lta_flight.replay.decisions import Decision, decisions
from lta_flight.replay.heard import heard
from lta_report.json_value import finite

Word = Literal['identical', 'same', 'different']


@final
@dataclass(frozen=True, slots=True)
class Verdict:
    """
    A replay against its recording.

    Attributes
    ----------
    topics : tuple of Compared
        What the nodes answered, topic by topic.
    decisions : tuple of Decision
        What was decided.
    elsewhere : tuple of str
        In what the recording's origin differs from here: platform, libraries, commit.
    start_ns : int
        Time 0. [ns]

    """

    topics: tuple[Compared, ...]
    decisions: tuple[Decision, ...]
    elsewhere: tuple[str, ...]
    start_ns: int

    @property
    def word(self) -> Word:
        """The verdict in a word."""
        if not any(topic.differing for topic in self.topics):
            return 'identical'
        changed = any(decision.changed for decision in self.decisions)
        close = all(topic.close for topic in self.topics)
        return 'same' if self.elsewhere and close and not changed else 'different'

    @property
    def sentence(self) -> str:
        """The verdict in a sentence, without a full stop."""
        total = sum(topic.count for topic in self.topics)
        if self.word == 'identical':
            each = ', '.join(f'{topic.count} of {topic.topic}' for topic in self.topics)
            return f'Identical to the last bit: {total} messages ({each})'
        differing = sum(topic.differing for topic in self.topics)
        if self.word == 'same':
            where = ' and '.join(self.elsewhere)
            return (
                f'The same within {TOLERANCE:g}, all decisions too: {differing} of {total} '
                f'messages differ in the last places, as they may with another {where}'
            )
        changed = sum(decision.changed for decision in self.decisions)
        return f'Different: {differing} of {total} messages, {changed} decisions'

    def seconds(self, key_ns: int) -> float:
        """Return a message's time since the start of the recording. [s]"""
        return (key_ns - self.start_ns) * 1e-9

    def to_dict(self) -> dict[str, Any]:
        """Return everything but the columns, for JSON."""
        return {
            'verdict': self.word,
            'sentence': self.sentence,
            'elsewhere': list(self.elsewhere),
            'topics': {topic.topic: self._told(topic) for topic in self.topics},
            'decisions': {
                each.name: {
                    'compared': len(each.keys),
                    'changed': each.changed,
                    'largest': finite(each.largest),
                    'unit': each.unit,
                    'first_s': None if each.first is None else self.seconds(each.keys[each.first]),
                }
                for each in self.decisions
            },
        }

    def _told(self, topic: Compared) -> dict[str, Any]:
        return {
            'compared': topic.count,
            'differing': topic.differing,
            'only_recorded': topic.unmatched[0],
            'only_replayed': topic.unmatched[1],
            'channels': [
                {
                    'path': each.path,
                    'differing': each.count,
                    'first_s': self.seconds(topic.recorded.keys[each.first]),
                    'recorded': finite(each.recorded),
                    'replayed': finite(each.again),
                    'largest': finite(each.largest),
                    'within_tolerance': each.close,
                }
                for each in topic.channels
            ],
        }


def absolute(robot: str, name: str) -> str:
    """Return a topic's name in a bag, which may be without namespaces."""
    return robot_topic(robot, name) if robot else f'/{name}'


def judged(recorded: Flight, again: Flight, topics: Sequence[str]) -> Verdict:
    """
    Compare a replay with its recording.

    Parameters
    ----------
    recorded, again : Flight
        The recording and what the nodes answered.
    topics : sequence of str
        What they answer.

    Raises
    ------
    BadInput
        If the recording has none of it.

    """
    table = topic_table()
    found = []
    for name in topics:
        row = table[name]
        then = heard(recorded.bag, absolute(recorded.robot, name), row)
        now = heard(again.bag, absolute(again.robot, name), row)
        whole = not row.stamped and len(then.keys) == len(now.keys)
        if len(now.keys) and not whole:  # of a section, only what lies in it
            inside = (then.keys >= now.keys[0]) & (then.keys <= now.keys[-1])
            then = then.picked(inside.nonzero()[0])
        found.append(compared(name, then, now, row.stamped))
    if not any(topic.count for topic in found):
        raise BadInput(
            f"'{recorded.bag.path}' has no message of {', '.join(topics)} to compare with; replay "
            'it without --against.'
        )
    kept = tuple(topic for topic in found if topic.count or any(topic.unmatched))
    place = elsewhere(recorded.provenance, here())
    return Verdict(kept, tuple(decisions(kept)), tuple(place), recorded.start)
