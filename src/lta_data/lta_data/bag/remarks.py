"""Describe irregularities of a recording that are not losses."""

from lta_data.bag.mcap_file.rhythm import MessageIntervals
from lta_data.bag.reader import Bag

MOST = 10  # sentences of one kind, at most
WOVEN = 1_000_000_000  # ns; topics overlap by up to that if log time is publication time


def describe_irregularities(bag: Bag) -> list[str]:
    """Return one sentence for each irregularity in the contents and indexes of a bag."""
    return [
        *bag.remarks[:MOST],
        *describe_omitted(len(bag.remarks), 'remarks on the files of the bag'),
        *describe_empty_bag(bag),
        *describe_undecodable_topics(bag),
        *describe_time_irregularities(bag.read_rhythm(), bag.start),
    ]


def describe_omitted(count: int, what: str) -> list[str]:
    """Return a sentence on the number of remarks not listed."""
    return [f'There are {count - MOST} more {what}.'] if count > MOST else []


def describe_empty_bag(bag: Bag) -> list[str]:
    """Return the remark on a bag without messages."""
    return (
        []
        if any(topic.count for topic in bag.topics.values())
        else ['The bag contains no message.']
    )


def describe_undecodable_topics(bag: Bag) -> list[str]:
    """Return the remarks on topics that cannot be decoded."""
    told = [
        f"The messages of '{topic.name}' {topic.undecodable}; they are kept but not decoded."
        for _, topic in sorted(bag.topics.items())
        if topic.undecodable is not None
    ]
    return [*told[:MOST], *describe_omitted(len(told), 'topics that cannot be decoded')]


def describe_time_irregularities(rhythm: MessageIntervals, start: int | None) -> list[str]:
    """Return the remarks on backward steps and long silences; `start` in ns."""
    told = []
    if rhythm.backwards and rhythm.worst > WOVEN:
        whose = '' if rhythm.worst_topic is None else f" (on '{rhythm.worst_topic}')"
        told.append(
            f'The log time goes back at {rhythm.backwards} of {rhythm.count} messages, by up to '
            f'{rhythm.worst * 1e-9:.6g} s{whose}; they are kept in the order of recording.'
        )
    silences = rhythm.find_long_silences()
    for begin, end in silences[:MOST]:
        at = (begin - (start or 0)) * 1e-9
        told.append(
            f'No message was recorded for {(end - begin) * 1e-9:.6g} s, starting {at:.6g} s after '
            'the first message.'
        )
    return [*told, *describe_omitted(len(silences), 'long periods without a message')]
