# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Summarise a bag."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import final

from lta_bag.reader import Bag, read_bag
from lta_bag.version_1 import describe_old_topics
from lta_config.errors import format_count
from lta_data.bag.recorded_flight import list_robots
from rich.console import Console
from rich.table import Table

MAX_SENTENCES = 10  # sentences of one kind, at most


def describe_irregularities(bag: Bag) -> list[str]:
    """Return one sentence for each irregularity in the contents of a bag."""
    return [
        *bag.remarks[:MAX_SENTENCES],
        *describe_omitted(len(bag.remarks), 'remarks on the files of the bag'),
        *describe_empty_bag(bag),
        *describe_undecodable_topics(bag),
    ]


def describe_omitted(count: int, what: str) -> list[str]:
    """Return a sentence on the number of remarks not listed."""
    return [f'There are {count - MAX_SENTENCES} more {what}.'] if count > MAX_SENTENCES else []


def describe_empty_bag(bag: Bag) -> list[str]:
    """Return the remark on a bag without messages."""
    return (
        []
        if any(topic.count for topic in bag.topics.values())
        else ['The bag contains no message.']
    )


def describe_undecodable_topics(bag: Bag) -> list[str]:
    """Return the remarks on topics that cannot be decoded."""
    lines = [
        f"The messages of '{topic.name}' {topic.undecodable}; they are kept but not decoded."
        for _, topic in sorted(bag.topics.items())
        if topic.undecodable is not None
    ]
    return [*lines[:MAX_SENTENCES], *describe_omitted(len(lines), 'topics that cannot be decoded')]


@final
@dataclass(frozen=True, slots=True)
class TopicInfo:
    """
    One topic of a bag.

    `rate` is the mean over the whole bag in Hz, None for fewer than two messages.
    """

    name: str
    type: str
    count: int
    rate: float | None


@final
@dataclass(frozen=True, slots=True)
class BagInfo:
    """Summary of a bag."""

    path: str  # the opened path
    size: int  # size of its MCAP files [bytes]
    start: int | None  # first log time; None without messages [ns]
    duration: float  # from the first to the last log time [s]
    messages: int
    robots: list[str]  # namespaces of the robots
    topics: list[TopicInfo]
    provenance: dict[str, str]
    complete: bool  # whether nothing is missing
    losses: list[str]  # what is missing, one sentence each
    # Irregularities without loss, one sentence each
    remarks: list[str] = field(default_factory=list)


def summarize_bag(path: Path | str) -> BagInfo:
    """Return the summary of a bag; raise BadInput if there is no recording at `path`."""
    bag = read_bag(path)
    seconds = bag.duration
    old = describe_old_topics(bag.path, bag.types, bag.provenance)
    topics = [
        TopicInfo(
            topic.name,
            topic.type_name,
            topic.count,
            # On /tf_static each publisher sends once, whatever their number
            (topic.count - 1) / seconds
            if topic.count > 1 and seconds > 0 and topic.name != '/tf_static'
            else None,
        )
        for _, topic in sorted(bag.topics.items())
    ]
    return BagInfo(
        path=str(path),
        size=bag.size,
        start=bag.start,
        duration=seconds,
        messages=sum(topic.count for topic in topics),
        robots=list_robots(bag),
        topics=topics,
        provenance=bag.provenance,
        complete=bag.is_complete,
        losses=list(bag.losses),
        remarks=describe_irregularities(bag) + ([old] if old else []),
    )


def print_bag_info(info: BagInfo, console: Console) -> None:
    """Print the summary of a bag; of stored files only the number of lines."""
    console.print(info.path, style='bold', highlight=False, markup=False)
    several = f' of {" and ".join(info.robots)}' if len(info.robots) > 1 else ''
    console.print(
        f'{format_count(info.messages, "message")}{several} in {info.duration:.2f} s, '
        f'{info.size / 1e6:.1f} MB',
        highlight=False,
    )
    table = Table(box=None, pad_edge=False)
    table.add_column('topic')
    table.add_column('type', style='dim')
    table.add_column('messages', justify='right')
    table.add_column('rate [Hz]', justify='right')
    for topic in info.topics:
        rate = '' if topic.rate is None else f'{topic.rate:.1f}'
        table.add_row(topic.name, topic.type, str(topic.count), rate)
    console.print(table)
    for key, value in info.provenance.items():
        lines = len(value.splitlines())
        text = value if lines < 2 else f'{lines} lines (print them with --json)'
        console.print(f'{key}: {text}', style='dim', highlight=False, markup=False)
    for sentence in (*info.losses, *info.remarks):
        console.print(sentence, style='yellow', highlight=False, markup=False)
    if info.losses:
        advice = 'To copy the readable messages to a new bag, run `lta import`.'
        console.print(advice, highlight=False, markup=False)
