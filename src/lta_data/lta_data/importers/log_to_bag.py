"""Write a log as a bag: convert its tables, pass its messages on, all in the log's order."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from heapq import merge
from operator import itemgetter
from pathlib import Path
from typing import final

from lta_bridge.bag.qos import build_offered_qos
from lta_bridge.bag.writer import BagWriter
from lta_data.importers.converter import ConvertedMessages, TopicConverter, ValueOutOfBounds
from lta_data.importers.log_table import join_tables, LogTable, Numbers, Times
from lta_data.importers.mapping_choice import MappingChoice
from lta_data.importers.protocol import LogReader, Reached
import numpy as np


@final
class LogRemarks:
    """Counts irregular times and missing numbers over all parts of a log; data stay unchanged."""

    def __init__(self) -> None:
        self._rows: Counter[str] = Counter()
        self._nan: Counter[str] = Counter()
        self._back: Counter[str] = Counter()
        self._same: Counter[str] = Counter()
        self._last: dict[str, int] = {}
        self._where: dict[str, int] = {}

    def add_rows(self, name: str, stamps: Times, columns: Mapping[str, Numbers]) -> None:
        """Count the next rows of a table: their times, and the columns in use."""
        if not len(stamps):
            return
        # Without an earlier part the first step counts as forward.
        before = self._last.get(name, int(stamps[0]) - 1)
        # Includes the step from the last row of the previous part
        steps = np.diff(stamps, prepend=before)
        self._back[name] += int((steps < 0).sum())
        self._same[name] += int((steps == 0).sum())
        if (steps < 0).any() and name not in self._where:
            # argmax of a mask: the first True; rows count from 1
            self._where[name] = self._rows[name] + int(np.argmax(steps < 0)) + 1
        self._rows[name] += len(stamps)
        self._last[name] = int(stamps[-1])
        for column, numbers in columns.items():
            holes = int(np.isnan(numbers).sum())
            if holes:
                self._nan[f'{name}.{column}' if name else column] += holes

    def format_remarks(self) -> list[str]:
        """Return the remarks, one sentence each."""
        lines = []
        for name, count in sorted(self._back.items()):
            if count:
                lines.append(
                    f'The time{_format_owner(name)} goes back {_format_times(count)}, first '
                    f'in row {self._where[name]}; these rows are kept.'
                )
        for name, count in sorted(self._same.items()):
            if count:
                lines.append(
                    f'The time{_format_owner(name)} repeats {_format_times(count)}; these '
                    'rows are kept.'
                )
        for column, count in sorted(self._nan.items()):
            lines.append(
                f"Column '{column}' lacks a number {_format_times(count)}; the bag has NaN there."
            )
        return lines


def _format_owner(name: str) -> str:
    return f" of '{name}'" if name else ''


def _format_times(count: int) -> str:
    return 'once' if count == 1 else f'{count} times'


Message = tuple[int, str, int, bytes]  # position in the log, topic, log time in ns, CDR
QOS = [build_offered_qos('reliable', 'volatile', 10)]  # for topics that no publisher offered


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
    remarks, notes = LogRemarks(), list[str]()
    converters = [TopicConverter(plan) for plan in chosen.plans]
    parts = _iterate_converted(log, converters, remarks, notes, reached)
    first = next(parts, [])  # reading the first part completes log.facts
    counts: Counter[str] = Counter()
    with BagWriter(bag, provenance | log.facts) as writer:
        names = _announce_topics(writer, log, converters, chosen)
        for messages in _iterate_runs(log, names, first, parts, reached):
            for _, topic, log_time, data in messages:
                writer.write(topic, data, log_time)
                counts[topic] += 1
    topics = {converter.plan.topic for converter in converters} | set(names.values())
    notes += [*_describe_unused(converters, chosen, log), *remarks.format_remarks(), *log.notes]
    return {topic: counts[topic] for topic in sorted(topics)}, notes


def _iterate_runs(
    log: LogReader,
    names: dict[str, str],
    first: list[ConvertedMessages],
    parts: Iterable[list[ConvertedMessages]],
    reached: Reached,
) -> Iterator[Iterator[Message]]:
    """Yield runs of messages: one merged run for a bag, otherwise one run per part."""
    if log.raw:
        passed = (
            (one.order, names[one.topic], one.log_time, one.data)
            for one in log.iterate_messages(reached)
            if one.topic in names
        )
        # heapq.merge keeps memory small: both sides are already in the log's order.
        yield merge(_merge_in_order(first), passed, key=itemgetter(0))
        return
    yield _merge_in_order(first)
    yield from map(_merge_in_order, parts)


def _announce_topics(
    writer: BagWriter, log: LogReader, converters: list[TopicConverter], chosen: MappingChoice
) -> dict[str, str]:
    """Add all topics to the bag; return the new names of those that are passed on."""
    converted = {converter.plan.entry.table for converter in converters}
    names = {name: chosen.renamed.get(name, name) for name in log.raw if name not in converted}
    for name, ours in names.items():
        writer.add_topic(ours, log.raw[name].definition, log.raw[name].qos)
    for converter in converters:
        writer.add_topic(converter.plan.topic, converter.plan.target.type_name, QOS)
    return names


def _iterate_converted(
    log: LogReader,
    converters: list[TopicConverter],
    remarks: LogRemarks,
    notes: list[str],
    reached: Reached,
) -> Iterator[list[ConvertedMessages]]:
    """Yield the converted messages, one part of the log at a time."""
    columns_by_table: dict[str, set[str]] = {}
    for converter in converters:
        entry = converter.plan.entry
        columns_by_table.setdefault(entry.table or '', set()).update(entry.columns)
        for other in entry.join:
            # Joined tables must be read, too; their columns carry the table's name as prefix
            columns_by_table.setdefault(other, set())
    if not columns_by_table:
        return
    for tables in log.iterate_tables(columns_by_table, reached):
        for name, table in tables.items():
            used = {
                column: table.columns[column]
                for column in columns_by_table[name] & {*table.columns}
            }
            remarks.add_rows(name, table.stamps, used)
        messages = []
        # A copy, since converters are removed while iterating
        for converter in list(converters):
            one = _convert_topic(converter, tables, notes)
            if one is None:
                # Drop the topic for the rest of the log as well.
                converters.remove(converter)
            else:
                messages.append(one)
        yield messages


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
