"""Which channel of A is compared with which of B: by name, or as told."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

from lta_config.errors import BadInput
from lta_data.bag.channels import Channel
from lta_data.compare.line import known_only

AS: Final = '--pair odom=ground_truth/odom'


class Wanted(NamedTuple):
    """Two topics to be compared, and the field of each where it is a single channel."""

    topic_a: str
    topic_b: str
    field_a: str = ''
    field_b: str = ''


class Pair(NamedTuple):
    """One quantity of both flights; `name` is A's."""

    name: str
    a: Channel
    b: Channel

    @property
    def angular(self) -> bool:
        """Whether values 2 pi apart mean the same."""
        return self.a.angular and self.b.angular


def wanted_pairs(
    asked: Sequence[str], only: Collection[str], of_a: Sequence[str], of_b: Sequence[str]
) -> list[Wanted]:
    """
    Return the topics to compare.

    Parameters
    ----------
    asked : sequence of str
        'odom=ground_truth/odom', of topics or of channels; empty for all of the same name.
    only : collection of str
        Names to keep, of topics of A; empty for all.
    of_a, of_b : sequence of str
        Topics of the flights.

    Raises
    ------
    BadInput
        If a pair cannot be read or a topic is not there, or nothing is common.

    """
    if asked:
        found = [told_pair(text, of_a, of_b) for text in asked]
    else:
        found = [Wanted(topic, topic) for topic in of_a if topic in set(of_b)]
        if not found:
            raise BadInput(
                f'The flights have no topic in common (A: {", ".join(of_a) or "none"}; B: '
                f'{", ".join(of_b) or "none"}); say which belong together, as in {AS}.'
            )
    for name in only:
        if name not in {each.topic_a for each in found}:
            common = ', '.join(sorted({each.topic_a for each in found}))
            raise BadInput(f"Topic '{name}' is not compared; those that are: {common}.")
    return [each for each in found if not only or each.topic_a in only]


def told_pair(text: str, of_a: Sequence[str], of_b: Sequence[str]) -> Wanted:
    """Return two topics or channels that somebody wrote as 'a=b'."""
    first, equals, second = text.partition('=')
    if not equals or not first or not second:
        raise BadInput(f"'{text}' is no pair; write A's topic, '=' and B's, as in {AS}.")
    topic_a, field_a = split(first, of_a, 'A')
    topic_b, field_b = split(second, of_b, 'B')
    if bool(field_a) != bool(field_b):
        raise BadInput(f"'{text}' pairs a topic with a channel; give two topics or two channels.")
    return Wanted(topic_a, topic_b, field_a, field_b)


def split(name: str, topics: Sequence[str], label: str) -> tuple[str, str]:
    """Return topic and field of a name; the field is '' where the name is a topic's."""
    name = name.removeprefix('/') if name not in topics else name
    if name in topics:
        return name, ''
    topic, _, field = name.rpartition('/')
    if topic in topics:
        return topic, field
    known = ', '.join(topics) or 'none'
    raise BadInput(f"{label} has no topic or channel '{name}'; its topics: {known}.")


class Paired(NamedTuple):
    """The pairs, and a sentence for each that cannot be compared."""

    pairs: list[Pair]
    remarks: list[str]


def paired(wanted: Sequence[Wanted], a: Mapping[str, Channel], b: Mapping[str, Channel]) -> Paired:
    """
    Return the channels that belong together.

    Fields belong together where they are the same, or one ends with the other: what a PoseStamped
    calls `pose.position.x` an Odometry calls `pose.pose.position.x`.

    Raises
    ------
    BadInput
        If a channel that was asked for is not there, or none is common.

    """
    found = Paired([], [])
    for each in wanted:
        fields_a = [channel.field for channel in a.values() if channel.topic == each.topic_a]
        fields_b = [channel.field for channel in b.values() if channel.topic == each.topic_b]
        for field_a, field_b in matches(each, fields_a, fields_b):
            name = f'{each.topic_a}/{field_a}'
            one, other = a[name], b[f'{each.topic_b}/{field_b}']
            if one.unit and other.unit and one.unit != other.unit:
                found.remarks.append(
                    f"'{name}' is in {one.unit} in A and in {other.unit} in B; not compared."
                )
            else:
                found.pairs.append(Pair(name, numbers(one), numbers(other)))
    if not found.pairs:
        raise BadInput(
            f'The flights have no channel in common; say which topics belong together, as in {AS}.'
        )
    return found


def numbers(channel: Channel) -> Channel:
    """Return a channel with NaN for all that is no number."""
    return replace(channel, values=known_only(channel.values))


def matches(wanted: Wanted, of_a: Sequence[str], of_b: Sequence[str]) -> list[tuple[str, str]]:
    """Return the fields of two topics that belong together."""
    if wanted.field_a:
        for topic, field, known in (
            (wanted.topic_a, wanted.field_a, of_a),
            (wanted.topic_b, wanted.field_b, of_b),
        ):
            if field not in known:
                names = ', '.join(known)
                raise BadInput(f"Topic '{topic}' has no channel '{field}'; it has: {names}.")
        return [(wanted.field_a, wanted.field_b)]
    pairs = []
    for field in of_a:
        if field in of_b:
            pairs.append((field, field))
            continue
        ending = [
            other for other in of_b if other.endswith(f'.{field}') or field.endswith(f'.{other}')
        ]
        if len(ending) == 1 and ending[0] not in of_a:
            pairs.append((field, ending[0]))
    return pairs
