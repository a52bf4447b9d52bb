# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a replay: its comparison with the recording."""

from collections.abc import Mapping
import math
from typing import Any, Final

from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import format_count
from lta_flight.replay.decisions import DecisionComparison
from lta_flight.replay.replay_request import ReplayRequest
from lta_flight.replay.run import ReplayRun
from lta_flight.replay.verdict import ReplayVerdict
from lta_report.drawing import create_figure
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, RAW
from lta_report.report import Block, Picture, Report, TextSection, TextTable
import numpy as np
from plotly.graph_objects import Figure, Scatter

LISTED_CHANNELS: Final = 40  # channels in the table
MOST_LINE_POINTS: Final = 3000  # points of a line
CHANNEL_HEADS: Final = (
    'topic',
    'field',
    'differs',
    'first at [s]',
    'recorded',
    'replayed',
    'largest',
)
REPLAY_METHOD: Final = (
    'Every message of the replayed nodes is compared, field by field, with the recorded message '
    'of the same time stamp. "Differs": messages in which the field differs in any bit. '
    '"Largest": largest difference between replay and recording, in the unit of the field.'
)
VERDICT_WORDS: Final = {
    'identical': 'identical to the last bit', 'same': 'the same', 'different': 'different',
}  # fmt: skip


def build_report(
    played: ReplayRun,
    verdict: ReplayVerdict | None,
    order: ReplayRequest,
    provenance: Mapping[str, str],
) -> Report:
    """
    Return the report of a replay.

    `verdict`: its comparison with the recording, if it was compared. `provenance`: provenance of
    the recording.
    """
    # Without a comparison, only an incomplete replay is a failure
    failed = not played.is_complete or (verdict is not None and verdict.word == 'different')
    return Report(
        command='replay',
        subject=f'{" ".join(order.nodes)} · {relative_path(order.bag)}',
        headline=format_headline(played, verdict),
        introduction=describe_replay(verdict, order),
        tiles=build_tiles(verdict) if verdict else [],
        blocks=list_blocks(verdict) if verdict else [],
        data=to_json(played, verdict, order),
        facts=describe_provenance(provenance),
        commands=suggest_commands(order),
        closing=[*describe_changes(played, verdict), f'Bag  {relative_path(played.bag)}'],
        status=int(failed),
    )


def format_headline(played: ReplayRun, verdict: ReplayVerdict | None) -> str:
    """Return the verdict, or without one how much was played; an incomplete replay says so."""
    if not played.is_complete:
        result = f' {verdict.sentence}.' if verdict else ''
        return f'The replay stopped before the end of the recording.{result}'
    return f'{verdict.sentence}.' if verdict else format_player_status(played)


def describe_replay(verdict: ReplayVerdict | None, order: ReplayRequest) -> str:
    """Return a description of the replay in two sentences."""
    changed = ', '.join(order.changes) or 'none'
    pace = 'in lockstep' if order.rate is None else f'at {order.rate:g} times real time'
    place = ', '.join(verdict.elsewhere) or 'none' if verdict else 'not compared'
    return (
        f'These nodes were run again on the recorded sensor data, {pace}: '
        f'{", ".join(order.nodes)}. Requested changes: {changed}. Other differences from the '
        f'environment of the recording: {place}.'
    )


def build_tiles(verdict: ReplayVerdict) -> list[Tile]:
    """Return tiles for the verdict and each kind of decision."""
    total = sum(topic.count for topic in verdict.topics)
    differing = sum(topic.differing for topic in verdict.topics)
    tiles = [
        Tile(
            'verdict', VERDICT_WORDS[verdict.word], '', format_count(len(verdict.topics), 'topic')
        ),
        Tile('messages', str(total), '', f'{differing} differ'),
    ]
    return tiles + [
        Tile(
            each.name,
            str(each.change_count),
            f'of {len(each.keys)} changed',
            format_largest_change(each),
        )
        for each in verdict.decisions
        if each.change_count or not each.name.startswith('duty')
    ]


def format_largest_change(decision: DecisionComparison) -> str:
    """Return the largest change in words."""
    if not decision.change_count:
        return 'all as recorded'
    if not decision.unit:
        return 'changed'
    unit = '' if decision.unit == '1' else f' {decision.unit}'
    return f'by up to {format_value(decision.largest_change, 4)}{unit}'


def format_value(value: object, digits: int = 10) -> str:
    """Return a value as short text that still shows small differences."""
    if isinstance(value, float):
        return f'{value:.{digits}g}' if math.isfinite(value) else str(value)
    text = str(value)
    return text if len(text) <= 30 else f'{text[:29]}…'


def list_blocks(verdict: ReplayVerdict) -> list[Block]:
    """Return the table of differences, messages without counterpart, and the decisions."""
    alone = [
        f'{topic.topic}: {topic.unmatched[0]} recorded messages without a replayed one, '
        f'{topic.unmatched[1]} replayed ones without a recorded one; these are not compared.'
        for topic in verdict.topics
        if any(topic.unmatched)
    ]
    pictures = [
        Picture(
            f'decision-{k}', each.name.capitalize(), format_caption(each, verdict),
            plot_decision(each, verdict), height=230, timed=True,
        )
        for k, each in enumerate(verdict.decisions)
    ]  # fmt: skip
    return [
        build_channel_table(verdict),
        *([TextSection('Messages without counterpart', alone, printed=True)] if alone else []),
        *pictures,
    ]


def build_channel_table(verdict: ReplayVerdict) -> Block:
    """Return a table of the fields that differ, or a sentence that none does."""
    rows = [
        [
            topic.topic, each.path, f'{each.count} of {topic.count}',
            f'{verdict.relative_time(int(topic.recorded.keys[each.first])):.3f}',
            format_value(each.recorded), format_value(each.again), format_value(each.largest),
        ]
        for topic in verdict.topics
        for each in topic.channels
    ]  # fmt: skip
    if not rows:
        return TextSection('What differs', ('No field of any message differs.', REPLAY_METHOD))
    # The page lists the first fields only; JSON has all
    more = len(rows) - LISTED_CHANNELS
    rest = f'And {more} more fields; all are in replay.json. ' if more > 0 else ''
    return TextTable(
        'What differs',
        CHANNEL_HEADS,
        rows[:LISTED_CHANNELS],
        f'{rest}{REPLAY_METHOD}',
        printed=False,
    )


def format_caption(decision: DecisionComparison, verdict: ReplayVerdict) -> str:
    """Return a caption with the time of the first change."""
    lines = 'Wide line: recording. Thin line: replay.'
    if decision.first_change is None:
        return f'{lines} They agree.'
    at = verdict.relative_time(int(decision.keys[decision.first_change]))
    return f'{lines} The first change is at {at:.2f} s.'


def plot_decision(decision: DecisionComparison, verdict: ReplayVerdict) -> Figure:
    """Return a figure of a decision over time, recorded and replayed."""
    figure = create_figure()
    rows = np.arange(len(decision.keys))
    # Decisions are held between messages, so skipping rows keeps the picture
    rows = rows[:: max(1, len(rows) // MOST_LINE_POINTS)]
    time = (decision.keys[rows] - verdict.start_ns) * 1e-9
    # Angles are shown in degrees
    turned = decision.unit == 'rad'
    scale, unit = (180.0 / math.pi, '°') if turned else (1.0, decision.unit)
    pairs = (
        ('recorded', decision.recorded, RAW, 5.0),
        ('replayed', decision.again, ESTIMATE, 1.5),
    )
    for name, values, colour, width in pairs:
        figure.add_trace(
            Scatter(
                x=time, y=values[rows] * scale, mode='lines', name=name,
                line={'color': colour, 'width': width, 'shape': 'hv'},
                hovertemplate=f'%{{y:.4g}} {unit}',
            )
        )  # fmt: skip
    figure.update_xaxes(title_text='time [s]')
    figure.update_yaxes(title_text=f'{decision.name}{f" [{unit}]" if unit else ""}')
    return figure


def describe_changes(played: ReplayRun, verdict: ReplayVerdict | None) -> list[str]:
    """Return what the terminal tells: progress, first differences, and changed decisions."""
    if verdict is None:
        return []
    lines = [format_player_status(played)] if played.is_complete else []
    for topic in verdict.topics:
        # The channels are sorted by the time of their first difference
        for first in topic.channels[:1]:
            at = verdict.relative_time(int(topic.recorded.keys[first.first]))
            lines.append(
                f'{topic.topic}: {topic.differing} of {topic.count} messages differ, first '
                f'{first.path} at {at:.2f} s ({format_value(first.recorded, 7)} recorded, '
                f'{format_value(first.again, 7)} replayed).'
            )
    for each in verdict.decisions:
        if each.first_change is not None:
            at = verdict.relative_time(int(each.keys[each.first_change]))
            how = f', {format_largest_change(each)}' if each.unit else ''
            lines.append(
                f'{each.name}: {each.change_count} of {len(each.keys)} decisions differ from the '
                f'recording, first at {at:.2f} s{how}.'
            )
    return lines


def format_player_status(played: ReplayRun) -> str:
    """Return how much was played, and how fast."""
    status = played.standing or {}
    return (
        f'Replayed {status["time_s"]} s at {status["pace"]} x real time: '
        f'{status["messages"]} messages played, {status["answers"]} output messages.'
    )


def to_json(
    played: ReplayRun, verdict: ReplayVerdict | None, order: ReplayRequest
) -> dict[str, Any]:
    """Return the results as JSON content."""
    return {
        'bag': str(played.bag),
        'whole': played.is_complete,
        'player': played.standing,
        'changes': order.changes,
        **(verdict.to_dict() if verdict else {}),
    }


def describe_provenance(provenance: Mapping[str, str]) -> dict[str, str]:
    """Return the provenance of the recording."""
    names = ('vehicle', 'scenario', 'strategy', 'seed', 'time', 'created', 'commit', 'platform')
    entries = {name: provenance[name] for name in names if name in provenance}
    return entries or {'recording': 'has no provenance'}


def suggest_commands(order: ReplayRequest) -> dict[str, str]:
    """Return commands for the next steps."""
    return {'See the recording': format_lta_command('report', relative_path(order.bag))}
