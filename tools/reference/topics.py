# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write the topic table as a page: `make reference`.

A test checks that the page in docs/ is up to date.
"""

from lta_config.topics import load_topic_table

HEAD = """# Topics

Generated from `config/topics.yaml` by `make reference`.

Names are relative to the robot's namespace (default `lta1`), except those with a leading slash.
Units and axes follow REP-103: ENU world, FLU body. "After" is the time from a message's stamp to
its publication. A subscriber marked *+1* uses a message one control period after its publication.
A light block has {samples} samples of each diode, taken at {rate:g} kS/s.

The definitions of `lta_msgs` are in `src/lta_msgs`, with units in the comments; `make build`
compiles them. Channels name the `duty` of an `ActuatorDuty` as an import does, which may know a
force instead: `motors/effort.up_left`. Bags of version 1 had standard messages on `photodiodes`,
`light/peaks`, `motors` and `energy/status`: `lta bag upgrade BAG` converts them.

| topic | type | from | to | period | after | quality of service | unit | what |
|---|---|---|---|---|---|---|---|---|
"""


def format_milliseconds(nanoseconds: int) -> str:
    """Return a time as a table cell, empty for 0."""
    return f'{nanoseconds / 1e6:g} ms' if nanoseconds else ''


def render_page() -> str:
    """Return the page, with one row per topic."""
    table = load_topic_table()
    rows = []
    for name, topic in table.topics.items():
        # A lag of control periods is appended to the role, as in 'controller *+1*'
        readers = ', '.join(
            f'{role} *+{lag}*' if lag else role for role, lag in topic.subscribers.items()
        )
        cells = (
            f'`{name}`',
            topic.type.replace('/msg/', '/'),
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
