# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Texts with columns, and the head of a mapping for them."""

ODOM = '/lta1/ground_truth/odom'
HEAD = 'schema: 1\nname: mine\nabout: a test\nformat: csv\n'
POSE = HEAD + (
    'time: {column: t, unit: s}\n'
    'topics:\n'
    '  - topic: ground_truth/odom\n'
    '    position: {columns: [x, y, z], unit: m}\n'
)


def text(path, *lines):
    path.write_text('\n'.join(lines) + '\n')
    return path
