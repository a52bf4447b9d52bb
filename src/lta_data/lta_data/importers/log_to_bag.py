# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Write a log as a bag: convert its tables, pass its messages on, all in the log's order."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from heapq import merge
from operator import itemgetter
from pathlib import Path

from lta_bag.metadata import build_offered_qos
from lta_bag.writer import BagWriter
from lta_data.importers.converter import ConvertedMessages, TopicConverter, ValueOutOfBounds
from lta_data.importers.mapping_choice import MappingChoice
from lta_data.importers.protocol import join_tables, LogReader, LogTable, Reached
import numpy as np
from numpy.typing import NDArray


def _describe_oddities(
    used: Mapping[str, LogTable], rows_in_bag: Mapping[tuple[str, str], NDArray[np.bool_]]
) -> list[str]:
    """
    Return remarks on irregular times and missing numbers, which stay as they are.

    `rows_in_bag`: the rows of which the bag has messages, by table and column.
    """
    back, same, lacking = [], [], {}
    for name, table in sorted(used.items()):
        steps = np.diff(table.stamps)
        wrong = np.flatnonzero(steps < 0)
        if len(wrong):
            back.append(
                f'The time{_format_owner(name)} goes back {_format_times(len(wrong))}, first in '
                f'row {wrong[0] + 2}; these rows are kept.'
            )
        if count := int((steps == 0).sum()):
            same.append(
                f'The time{_format_owner(name)} repeats {_format_times(count)}; these rows are '
                'kept.'
            )
    for (name, column), rows in rows_in_bag.items():
        if holes := int(np.isnan(used[name].columns[column][rows]).sum()):
            lacking[f'{name}.{column}' if name else column] = holes
    return [*back, *same, *(
        f"Column '{column}' lacks a number {_format_times(count)}; the bag has NaN there."
        for column, count in sorted(lacking.items())
    )]  # fmt: skip


def _format_owner(name: str) -> str:
    return f" of '{name}'" if name else ''


def _format_times(count: int) -> str:
    return 'once' if count == 1 else f'{count} times'


Message = tuple[int, str, int, bytes]  # position in the log, topic, log time in ns, CDR
DEFAULT_QOS = [
    build_offered_qos('reliable', 'volatile', 10)
]  # for topics that no publisher offered


def write_log_bag(
    log: LogReader, chosen: MappingChoice, bag: Path, provenance: dict[str, str], reached: Reached
) -> tuple[dict[str, int], list[str]]:
    """
    Write an opened log as a bag.

    Returns
    -------
    dict of str to int
        Messages by topic.
    list of str
        Remarks on odd, missing or omitted data, one sentence each.

    """
    notes = list[str]()
    converters = [TopicConverter(plan) for plan in chosen.plans]
    used = _read_used_tables(log, converters)
    reached(0.0 if log.raw else 0.5)  # reading is done, writing the bag is not
    pairs = [
        (converter, one) for converter in converters
        if (one := _convert_topic(converter, used, notes)) is not None
    ]  # fmt: skip
    converters = [converter for converter, _ in pairs]
    converted = [one for _, one in pairs]
    counts: Counter[str] = Counter()
    # What the source says of itself is kept beside what this import says
    facts = {
        f'original_{key}' if key in provenance else key: text for key, text in log.facts.items()
    }
    with BagWriter(bag, provenance | facts) as writer:
        names = _announce_topics(writer, log, converters, chosen)
        for _, topic, log_time, data in _iterate_ordered(log, names, converted, reached):
            writer.write(topic, data, log_time)
            counts[topic] += 1
    topics = {converter.plan.topic for converter in converters} | set(names.values())
    oddities = _describe_oddities(used, _find_rows_in_bag(used, pairs))
    notes += [*_describe_unused(converters, chosen, log), *oddities, *log.notes]
    return {topic: counts[topic] for topic in sorted(topics)}, notes


def _iterate_ordered(
    log: LogReader,
    names: dict[str, str],
    converted: list[ConvertedMessages],
    reached: Reached,
) -> Iterator[Message]:
    """Return all messages in the order of the log."""
    passed = (
        (one.order, names[one.topic], one.log_time, one.data)
        for one in log.iterate_messages(reached)
        if one.topic in names
    )
    # heapq.merge keeps memory small: both sides are already in the log's order.
    return merge(_merge_in_order(converted), passed, key=itemgetter(0))


def _announce_topics(
    writer: BagWriter, log: LogReader, converters: list[TopicConverter], chosen: MappingChoice
) -> dict[str, str]:
    """Add all topics to the bag; return the new names of those that are passed on."""
    converted = {converter.plan.entry.table for converter in converters}
    names = {name: chosen.renamed.get(name, name) for name in log.raw if name not in converted}
    for name, ours in names.items():
        writer.add_topic(ours, log.raw[name].definition, log.raw[name].qos)
    for converter in converters:
        writer.add_topic(converter.plan.topic, converter.plan.target.type_name, DEFAULT_QOS)
    return names


def _read_used_tables(
    log: LogReader, converters: Sequence[TopicConverter]
) -> Mapping[str, LogTable]:
    """Return the tables of which topics are made."""
    columns_by_table: dict[str, set[str]] = {}
    for entry in (converter.plan.entry for converter in converters):
        columns_by_table.setdefault(entry.table or '', set()).update(entry.columns)
        for other in entry.join:
            # Joined tables must be read, too; their columns carry the table's name as prefix
            columns_by_table.setdefault(other, set())
    return log.read_tables(columns_by_table)


def _find_rows_in_bag(
    used: Mapping[str, LogTable], pairs: Sequence[tuple[TopicConverter, ConvertedMessages]]
) -> dict[tuple[str, str], NDArray[np.bool_]]:
    """Return the rows of which the bag has messages, by table and column that a topic names."""
    rows_in_bag: dict[tuple[str, str], NDArray[np.bool_]] = {}
    for converter, messages in pairs:
        name = converter.plan.entry.table or ''
        for column in converter.plan.entry.columns:
            if column in used[name].columns:
                none = np.zeros(len(used[name]), dtype=np.bool_)
                rows_in_bag.setdefault((name, column), none)[messages.rows] = True
    return rows_in_bag


def _convert_topic(
    converter: TopicConverter, tables: Mapping[str, LogTable], notes: list[str]
) -> ConvertedMessages | None:
    """Convert one topic; None if it is optional and its values are out of bounds."""
    entry = converter.plan.entry
    table, age = join_tables(
        tables[entry.table or ''], {name: tables[name] for name in entry.join}
    )
    try:
        converted = converter.convert(table)
    except ValueOutOfBounds as wrong:
        if not entry.optional or entry.table is None:
            raise
        notes.append(f"Topic '{entry.topic}' is left out: {wrong}")
        return None
    if entry.join:
        others = ' and '.join(entry.join)
        notes.append(
            f"Topic '{entry.topic}' has the times of {entry.table} and the latest logged "
            f'values of {others}, which are at most {age * 1e-9:.3g} s old.'
        )
    return converted


def _merge_in_order(converted: list[ConvertedMessages]) -> Iterator[Message]:
    """Yield the messages of several topics in the order of the log."""
    keys = np.concatenate([np.empty(0, dtype=np.int64), *(one.order for one in converted)])
    which = np.repeat(np.arange(len(converted)), [len(one.order) for one in converted])
    starts = np.cumsum([0, *(len(one.order) for one in converted)])
    # `which` is the second key: at equal positions the topics keep the mapping's order.
    ranks = np.lexsort((which, keys))
    owners = which[ranks].tolist()
    inside = (ranks - starts[which[ranks]] if len(ranks) else ranks).tolist()
    times = [one.log_times.tolist() for one in converted]
    orders = keys[ranks].tolist()
    for order, owner, index in zip(orders, owners, inside, strict=True):
        one = converted[owner]
        data = one.data[index * one.size : (index + 1) * one.size]
        yield order, one.topic, times[owner][index], data


def _describe_unused(
    converters: list[TopicConverter], chosen: MappingChoice, log: LogReader
) -> Iterator[str]:
    """Yield a remark on everything in the log that is not in the bag."""
    for converter in converters:
        topic = converter.plan.topic
        if converter.without:
            yield f'{converter.without} rows have no values for {topic} and are left out there.'
        if converter.excluded:
            yield f'The mapping excludes {converter.excluded} rows from {topic}.'
        if converter.silent:
            yield (
                f'These parts of {topic} have no values and are left out: '
                f'{", ".join(converter.silent)}.'
            )
    if chosen.absent:
        yield f'The log has no data for these topics of the mapping: {", ".join(chosen.absent)}.'
    used: dict[str, set[str]] = {}
    for converter in converters:
        entry = converter.plan.entry
        used.setdefault(entry.table or '', set()).update(entry.columns)
        for name in entry.join:
            prefix = f'{name}.'
            columns = {c.removeprefix(prefix) for c in entry.columns if c.startswith(prefix)}
            used.setdefault(name, set()).update(columns)
    if log.raw:
        return
    for name, columns_ in sorted(log.columns.items()):
        unread = [c for c in columns_ if c not in used.get(name, set()) and c not in log.timed]
        where = f"'{name}'" if name else 'the log'
        if name and name not in used:
            yield f"The mapping does not use '{name}' of the log."
        elif unread:
            yield f'The mapping does not use these columns of {where}: {", ".join(unread)}.'
