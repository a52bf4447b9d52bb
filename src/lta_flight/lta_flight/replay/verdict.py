# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Judge whether a replay equals its recording: in every bit, within tolerance, or not."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final, Literal

from lta_bag.provenance import describe_environment
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table, robot_topic
from lta_data.bag.recorded_flight import RecordedFlight
from lta_flight.replay.comparison import (
    compare_topic,
    find_origin_differences,
    read_topic,
    TOLERANCE,
    TopicComparison,
)
from lta_flight.replay.decisions import compare_decisions, DecisionComparison
from lta_report.json_value import replace_nonfinite

Word = Literal['identical', 'same', 'different']


@final
@dataclass(frozen=True, slots=True)
class ReplayVerdict:
    """The comparison of a replay with its recording."""

    topics: tuple[TopicComparison, ...]  # the outputs of the nodes, topic by topic
    decisions: tuple[DecisionComparison, ...]
    elsewhere: tuple[str, ...]  # differences in provenance: platform, libraries, commit
    start_ns: int  # time 0 [ns]

    @property
    def word(self) -> Word:
        """Return the verdict as one word."""
        if not any(topic.differing for topic in self.topics):
            return 'identical'
        changed = any(decision.change_count for decision in self.decisions)
        close = all(topic.is_close for topic in self.topics)
        # The tolerance applies only to a recording from elsewhere
        return 'same' if self.elsewhere and close and not changed else 'different'

    @property
    def sentence(self) -> str:
        """Return the verdict as a sentence, without a full stop."""
        total = sum(topic.count for topic in self.topics)
        if self.word == 'identical':
            each = ', '.join(f'{topic.count} of {topic.topic}' for topic in self.topics)
            return f'Identical to the last bit: {total} messages ({each})'
        differing = sum(topic.differing for topic in self.topics)
        if self.word == 'same':
            where = ' and '.join(self.elsewhere)
            return (
                f'The same within {TOLERANCE:g}, with the same decisions: {differing} of {total} '
                f'messages differ in their last digits, as is usual with another {where}'
            )
        changed = sum(decision.change_count for decision in self.decisions)
        return (
            f'Different: {differing} of {total} messages and {changed} decisions are not as '
            'recorded'
        )

    def relative_time(self, key_ns: int) -> float:
        """Return a message's time since the start of the recording [s]."""
        return (key_ns - self.start_ns) * 1e-9

    def to_dict(self) -> dict[str, Any]:
        """Return everything except the columns, for JSON."""
        return {
            'verdict': self.word,
            'sentence': self.sentence,
            'elsewhere': list(self.elsewhere),
            'topics': {topic.topic: self._describe_topic(topic) for topic in self.topics},
            'decisions': {
                each.name: {
                    'compared': len(each.keys),
                    'changed': each.change_count,
                    'largest': replace_nonfinite(each.largest_change),
                    'unit': each.unit,
                    'first_s': None
                    if each.first_change is None
                    else self.relative_time(each.keys[each.first_change]),
                }
                for each in self.decisions
            },
        }

    def _describe_topic(self, topic: TopicComparison) -> dict[str, Any]:
        return {
            'compared': topic.count,
            'differing': topic.differing,
            'only_recorded': topic.unmatched[0],
            'only_replayed': topic.unmatched[1],
            'channels': [
                {
                    'path': each.path,
                    'differing': each.count,
                    'first_s': self.relative_time(topic.recorded.keys[each.first]),
                    'recorded': replace_nonfinite(each.recorded),
                    'replayed': replace_nonfinite(each.again),
                    'largest': replace_nonfinite(each.largest),
                    'within_tolerance': each.close,
                }
                for each in topic.channels
            ],
        }


def resolve_topic(robot: str, name: str) -> str:
    """Return a topic's name in a bag, which may have no namespaces."""
    return robot_topic(robot, name) if robot else f'/{name}'


def compare_with_recording(
    recorded: RecordedFlight, again: RecordedFlight, topics: Sequence[str]
) -> ReplayVerdict:
    """
    Compare a replay with its recording.

    `recorded`, `again`: the recording, and the outputs of the replay. `topics`: the topics to
    compare. Raise `BadInput` if the recording has none of these topics.
    """
    table = load_topic_table()
    topic_comparisons = []
    for name in topics:
        row = table[name]
        then = read_topic(recorded.bag, resolve_topic(recorded.robot, name), row)
        now = read_topic(again.bag, resolve_topic(again.robot, name), row)
        # Without stamps, equal numbers of messages mean that the whole recording was replayed
        whole = not row.stamped and len(then.keys) == len(now.keys)
        if len(now.keys) and not whole:  # compare only the replayed section
            # Recorded messages outside the section have no counterpart
            inside = (then.keys >= now.keys[0]) & (then.keys <= now.keys[-1])
            then = then.select_rows(inside.nonzero()[0])
        topic_comparisons.append(compare_topic(name, then, now, row.stamped))
    if not any(topic.count for topic in topic_comparisons):
        raise BadInput(
            f"'{recorded.bag.path}' has no message of {', '.join(topics)} to compare with; replay "
            'it without --against.'
        )
    with_messages = tuple(
        topic for topic in topic_comparisons if topic.count or any(topic.unmatched)
    )
    place = find_origin_differences(recorded.provenance, describe_environment())
    return ReplayVerdict(
        with_messages, tuple(compare_decisions(with_messages)), tuple(place), recorded.start
    )
