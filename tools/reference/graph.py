# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Draw the ROS graph as an N2 chart (Lano 1977) from the topic table.

Nodes are on the diagonal. A topic is in the row of its publisher and the column of its subscriber:
forward data flow is above the diagonal, feedback below it.
"""

from collections.abc import Sequence
from html import escape

from lta_config.topics import load_topic_table, TopicTable

WIDTH, LINE, MARGIN = 178, 15, 12  # of a column, a line of text and the edge [px]
SHOWN = 'all see'
STYLE = """
text { font: 11px sans-serif; fill: #333; }
.node { font: bold 13px sans-serif; fill: #fff; text-anchor: middle; }
.late { fill: #a04000; }
.box { fill: #3f51b5; }
.cell { fill: #eef1fb; stroke: #c5cae9; }
.back { fill: #fdf1e7; stroke: #f0c9a8; }
"""


def render_page() -> str:
    """Return the picture as SVG."""
    table = load_topic_table()
    roles = order_nodes(table)
    # The last column lists topics without a subscriber in the table
    columns = [*roles, SHOWN]
    rows = [[list_links(table, role, reader) for reader in columns] for role in roles]
    # A row is as high as its longest cell, at least three lines
    heights = [max(3, *(len(cell) for cell in row)) * LINE + 10 for row in rows]
    width, height = 2 * MARGIN + WIDTH * len(columns), 2 * MARGIN + LINE + sum(heights)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" '
        f'aria-label="Nodes on the diagonal, topics between them">\n<style>{STYLE}</style>\n'
        f'<rect width="{width}" height="{height}" fill="#fff"/>\n'
    ]
    top = MARGIN + LINE
    title = MARGIN + WIDTH * len(roles) + WIDTH // 2
    parts.append(f'<text x="{title}" y="{MARGIN + 8}" text-anchor="middle">to all others</text>\n')
    for k, (role, row, high) in enumerate(zip(roles, rows, heights, strict=True)):
        for column, lines in enumerate(row):
            left = MARGIN + WIDTH * column
            if column == k:
                parts.append(render_node_svg(role, left, top, high))
            elif lines:
                # Below the diagonal: feedback
                parts.append(
                    render_topics_svg(lines, left, top, high, 'back' if column < k else 'cell')
                )
        top += high
    return ''.join(parts) + '</svg>\n'


def order_nodes(table: TopicTable) -> list[str]:
    """Return the nodes with subscribers in the order of the table, the controller last."""
    sources = [topic.source for topic in table.topics.values() if topic.subscribers]
    roles = list(dict.fromkeys(sources))
    # `sorted` is stable: all other roles keep their order
    return sorted(roles, key=lambda role: role == 'controller')  # it closes the loop: last


def list_links(table: TopicTable, role: str, reader: str) -> list[tuple[str, bool]]:
    """Return topic and rate of each link between two nodes, and whether it is used a step late."""
    lines = []
    for name in table.published_by(role):
        topic = table[name]
        # The subscriber uses the value of the previous step
        late = bool(topic.subscribers.get(reader))
        if reader in topic.subscribers or (reader == SHOWN and not topic.subscribers):
            rate = f' {1e9 / topic.period_ns:.0f} Hz' if topic.period_ns else ''
            lines.append((f'{name}{rate}', late))
    return lines


def render_node_svg(role: str, left: int, top: int, high: int) -> str:
    """Return the SVG of a node on the diagonal."""
    middle, centre = left + WIDTH // 2, top + high // 2 + 4
    return (
        f'<rect class="box" x="{left + 4}" y="{top + 4}" width="{WIDTH - 8}" height="{high - 8}" '
        f'rx="6"/>\n<text class="node" x="{middle}" y="{centre}">{escape(role)}</text>\n'
    )


def render_topics_svg(
    lines: Sequence[tuple[str, bool]], left: int, top: int, high: int, kind: str
) -> str:
    """Return the SVG of the topics between two nodes; late ones have another colour."""
    box = (
        f'<rect class="{kind}" x="{left + 4}" y="{top + 4}" width="{WIDTH - 8}" '
        f'height="{high - 8}" rx="6"/>\n'
    )
    first = top + (high - LINE * len(lines)) // 2 + 11
    texts = [
        f'<text class="{"late" if late else "told"}" x="{left + 10}" y="{first + LINE * k}">'
        f'{escape(text)}{" +1" if late else ""}</text>\n'
        for k, (text, late) in enumerate(lines)
    ]
    return box + ''.join(texts)
