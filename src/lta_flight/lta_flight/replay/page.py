"""Write the comparison of a replay with its recording as one HTML file."""

from collections.abc import Mapping
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_config.command_line import format_lta_command, relative_path
from lta_flight.replay.decisions import DecisionComparison
from lta_flight.replay.replay_request import ReplayRequest
from lta_flight.replay.verdict import ReplayVerdict
from lta_report.drawing import create_figure
from lta_report.formatting import Tile
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_report.palette import ESTIMATE, RAW
import numpy as np
from plotly.graph_objects import Figure, Scatter

NAME: Final = 'report.html'
LISTED: Final = 40  # channels in the table
MOST: Final = 3000  # points of a line
METHOD: Final = (
    'Every message of the replayed nodes is compared, field by field, with the recorded message '
    'of the same time stamp. "Differs": messages in which the field differs in any bit. '
    '"Largest": largest difference between replay and recording, in the unit of the field.'
)
NAMES: Final = {
    'identical': 'identical to the last bit', 'same': 'the same', 'different': 'different',
}  # fmt: skip


def write_page(
    verdict: ReplayVerdict, order: ReplayRequest, provenance: Mapping[str, str], folder: Path
) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(verdict, order, provenance), folder / NAME)


def render_page(
    verdict: ReplayVerdict, order: ReplayRequest, provenance: Mapping[str, str]
) -> str:
    """
    Return the whole page.

    Parameters
    ----------
    verdict : ReplayVerdict
        The result.
    order : ReplayRequest
        The request.
    provenance : mapping of str to str
        Provenance of the recording.

    """
    return assemble_page(
        'replay.html',
        title=escape(f'{verdict.sentence}.'),
        kicker=escape(f'replay · {" ".join(order.nodes)} · {relative_path(order.bag)}'),
        about=escape(describe_replay(verdict, order)),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(verdict)),
        table=render_channel_table(verdict),
        notes=''.join(
            f'<p class="note">{escape(each)}</p>' for each in list_comparison_notes(verdict)
        ),
        pictures='\n'.join(
            render_section(
                f'decision-{k}', each.name.capitalize(), format_caption(each, verdict),
                plot_decision(each, verdict), timed=True,
            )
            for k, each in enumerate(verdict.decisions)
        ),
        facts=describe_provenance(provenance),
        commands=suggest_commands(order),
    )  # fmt: skip


def describe_replay(verdict: ReplayVerdict, order: ReplayRequest) -> str:
    """Return a description of the replay in two sentences."""
    changed = ', '.join(order.changes) or 'none'
    pace = 'in lockstep' if order.rate is None else f'at {order.rate:g} times real time'
    place = ', '.join(verdict.elsewhere) or 'none'
    return (
        f'These nodes were run again on the recorded sensor data, {pace}: '
        f'{", ".join(order.nodes)}. Requested changes: {changed}. Other differences from the '
        f'environment of the recording: {place}.'
    )


def build_tiles(verdict: ReplayVerdict) -> list[Tile]:
    """Return tiles for the verdict and each kind of decision."""
    total = sum(topic.count for topic in verdict.topics)
    differing = sum(topic.differing for topic in verdict.topics)
    made = [
        Tile('verdict', NAMES[verdict.word], '', f'{len(verdict.topics)} topics'),
        Tile('messages', str(total), '', f'{differing} differ'),
    ]
    return made + [
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


def render_channel_table(verdict: ReplayVerdict) -> str:
    """Return a table of the fields that differ, or a sentence that none does."""
    heads = ['topic', 'field', 'differs', 'first at [s]', 'recorded', 'replayed', 'largest']
    lines = []
    for topic in verdict.topics:
        for each in topic.channels:
            at = verdict.relative_time(int(topic.recorded.keys[each.first]))
            cells = (
                each.path, f'{each.count} of {topic.count}', f'{at:.3f}',
                format_value(each.recorded), format_value(each.again), format_value(each.largest),
            )  # fmt: skip
            own = ''.join(f'<td>{escape(cell)}</td>' for cell in cells)
            lines.append(f'<tr><th scope="row">{escape(topic.topic)}</th>{own}</tr>')
    if not lines:
        return '<p class="note">No field of any message differs.</p>'
    top = ''.join(f'<th scope="col">{head}</th>' for head in heads)
    # The page lists the first fields only; JSON has all
    more = len(lines) - LISTED
    rest = (
        f'<p class="note">And {more} more fields; all are in replay.json.</p>' if more > 0 else ''
    )
    return (
        '<table class="differences"><caption class="hidden">Fields that differ</caption>'
        f'<thead><tr>{top}</tr></thead><tbody>{"".join(lines[:LISTED])}</tbody></table>{rest}'
    )


def list_comparison_notes(verdict: ReplayVerdict) -> list[str]:
    """Return how the runs were compared, and which messages could not be."""
    alone = [
        f'{topic.topic}: {topic.unmatched[0]} recorded messages without a replayed one, '
        f'{topic.unmatched[1]} replayed ones without a recorded one; these are not compared.'
        for topic in verdict.topics
        if any(topic.unmatched)
    ]
    return [METHOD, *alone]


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
    rows = rows[:: max(1, len(rows) // MOST)]
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


def describe_provenance(provenance: Mapping[str, str]) -> dict[str, str]:
    """Return the provenance of the recording."""
    names = ('vehicle', 'scenario', 'strategy', 'seed', 'time', 'created', 'commit', 'platform')
    known = {name: provenance[name] for name in names if name in provenance}
    return known or {'recording': 'has no provenance'}


def suggest_commands(order: ReplayRequest) -> dict[str, str]:
    """Return commands for the next steps."""
    words: list[str | Path] = [
        'replay',
        relative_path(order.bag),
        '--nodes',
        ','.join(order.nodes),
        '--against',
    ]
    for node, given in order.settings.items():
        for name, value in given.items():
            words += ['--set', f'{node}.{name}={value}']
    return {
        'Replay it again': format_lta_command(*words),
        'See the recording': format_lta_command('report', relative_path(order.bag)),
    }
