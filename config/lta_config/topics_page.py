"""
Write the topic table as a page: `python -m lta_config.topics_page > docs/topics.md`.

A test checks that the page in docs/ is up to date.
"""

import sys

from lta_config.topics import load_topic_table, Topic, TopicTable

HEAD = """# Topics

Generated from `config/topics.yaml` by `python -m lta_config.topics_page > docs/topics.md`.

Names are relative to the robot's namespace (default `lta1`), except those with a leading slash.
Units and axes follow REP-103: ENU world, FLU body. "After" is the time from a message's stamp to
its publication. A subscriber marked *+1* uses a message one control period after its publication.
A light block has {samples} samples of each diode, taken at {rate:g} kS/s.

The types of `lta_msgs` (`src/lta_msgs`, with units in the comments) need a C++ compiler when the
workspace is built. Without one, or with `LTA_MESSAGES=standard` in the environment of all nodes,
these topics have the standard type that stands behind it; the numbers are the same. Every command
reads both, and gives their channels the same names, such as `motors/effort.up_left` (the field
`duty` of an `ActuatorDuty`) and `energy/status/power_in`. The nodes of a graph must use the same
types: set `LTA_MESSAGES=standard` everywhere if one of its machines has not built `lta_msgs`.

| topic | type | from | to | period | after | quality of service | unit | what |
|---|---|---|---|---|---|---|---|---|
"""


def format_milliseconds(nanoseconds: int) -> str:
    """Return a time as a table cell, empty for 0."""
    return f'{nanoseconds / 1e6:g} ms' if nanoseconds else ''


def format_type(topic: Topic) -> str:
    """Return the message type as a table cell, with the standard type that may stand in."""
    types = topic.declared_type, topic.standard_type
    return ' or '.join(each.replace('/msg/', '/') for each in types if each)


def render_page(table: TopicTable) -> str:
    """Return the page, with one row per topic."""
    rows = []
    for name, topic in table.topics.items():
        # A lag of control periods is appended to the role, as in 'controller *+1*'
        readers = ', '.join(
            f'{role} *+{lag}*' if lag else role for role, lag in topic.subscribers.items()
        )
        cells = (
            f'`{name}`',
            format_type(topic),
            topic.source,
            readers or 'users',
            format_milliseconds(topic.period_ns),
            format_milliseconds(topic.latency_ns),
            topic.qos,
            topic.unit,
            topic.about,
        )
        rows.append('| ' + ' | '.join(cells) + ' |\n')
    # kS/s
    rate = table.light.sample_rate.si / 1e3
    return HEAD.format(samples=table.light.samples, rate=rate) + ''.join(rows)


if __name__ == '__main__':
    sys.stdout.write(render_page(load_topic_table()))
