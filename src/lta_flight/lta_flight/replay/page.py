"""A replay against its recording as one self-contained page, in the look of a flight's page."""

from collections.abc import Mapping
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_config.typed import near, typed
from lta_flight.replay.decisions import Decision
from lta_flight.replay.order import Order
from lta_flight.replay.verdict import Verdict
from lta_report.drawing import blank
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.palette import ESTIMATE, RAW
from lta_report.pieces import section, tile_html
import numpy as np
from plotly.graph_objects import Figure, Scatter

NAME: Final = 'report.html'
LISTED: Final = 40  # channels in the table
MOST: Final = 3000  # points of a line
METHOD: Final = (
    'Every message of a node that was run again is held against the recorded one of the same '
    'stamp, field by field. Differs: in any bit. Largest: over the whole replay, in the unit of '
    'the field.'
)
NAMES: Final = {
    'identical': 'identical to the last bit', 'same': 'the same', 'different': 'different',
}  # fmt: skip


def write_page(verdict: Verdict, order: Order, told: Mapping[str, str], folder: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(verdict, order, told), folder / NAME)


def page(verdict: Verdict, order: Order, told: Mapping[str, str]) -> str:
    """
    Return the whole page.

    Parameters
    ----------
    verdict : Verdict
        What came out.
    order : Order
        What was asked for.
    told : mapping of str to str
        Where the recording comes from.

    """
    return framed(
        'replay.html',
        title=escape(f'{verdict.sentence}.'),
        kicker=escape(f'replay · {" ".join(order.nodes)} · {near(order.bag)}'),
        about=escape(about(verdict, order)),
        tiles='\n'.join(tile_html(*each) for each in tiles(verdict)),
        table=table_html(verdict),
        notes=''.join(f'<p class="note">{escape(each)}</p>' for each in notes(verdict)),
        pictures='\n'.join(
            section(
                f'decision-{k}', each.name.capitalize(), caption(each, verdict),
                picture(each, verdict), timed=True,
            )
            for k, each in enumerate(verdict.decisions)
        ),
        facts=facts(told),
        commands=commands(order),
    )  # fmt: skip


def about(verdict: Verdict, order: Order) -> str:
    """Return what was done, in two sentences."""
    changed = ', '.join(order.changes) or 'nothing'
    pace = 'in lockstep' if order.rate is None else f'at {order.rate:g} times real time'
    place = ', '.join(verdict.elsewhere) or 'nothing'
    return (
        f'Run again on the recorded sensors, {pace}: {", ".join(order.nodes)}. Changed by order: '
        f'{changed}. Since the recording, another: {place}.'
    )


def tiles(verdict: Verdict) -> list[Tile]:
    """Return the verdict, and each kind of decision."""
    total = sum(topic.count for topic in verdict.topics)
    differing = sum(topic.differing for topic in verdict.topics)
    made = [
        Tile('verdict', NAMES[verdict.word], '', f'{len(verdict.topics)} topics'),
        Tile('messages', str(total), '', f'{differing} differ'),
    ]
    return made + [
        Tile(each.name, str(each.changed), f'of {len(each.keys)} changed', largest(each))
        for each in verdict.decisions
        if each.changed or not each.name.startswith('duty')
    ]


def largest(decision: Decision) -> str:
    """Return the largest change in words."""
    if not decision.changed:
        return 'all as recorded'
    if not decision.unit:
        return 'otherwise'
    unit = '' if decision.unit == '1' else f' {decision.unit}'
    return f'by up to {figure(decision.largest, 4)}{unit}'


def figure(value: object, digits: int = 10) -> str:
    """Return a value short enough to be read, long enough to tell two apart."""
    if isinstance(value, float):
        return f'{value:.{digits}g}' if math.isfinite(value) else str(value)
    text = str(value)
    return text if len(text) <= 30 else f'{text[:29]}…'


def table_html(verdict: Verdict) -> str:
    """Return all channels that differ, or a sentence that there is none."""
    heads = ['topic', 'field', 'differs', 'first at [s]', 'recorded', 'replayed', 'largest']
    lines = []
    for topic in verdict.topics:
        for each in topic.channels:
            at = verdict.seconds(int(topic.recorded.keys[each.first]))
            cells = (
                each.path, f'{each.count} of {topic.count}', f'{at:.3f}', figure(each.recorded),
                figure(each.again), figure(each.largest),
            )  # fmt: skip
            own = ''.join(f'<td>{escape(cell)}</td>' for cell in cells)
            lines.append(f'<tr><th scope="row">{escape(topic.topic)}</th>{own}</tr>')
    if not lines:
        return '<p class="note">No field of any message differs.</p>'
    top = ''.join(f'<th scope="col">{head}</th>' for head in heads)
    more = len(lines) - LISTED
    rest = (
        f'<p class="note">And {more} more fields; all are in replay.json.</p>' if more > 0 else ''
    )
    return (
        '<table class="differences"><caption class="hidden">Fields that differ</caption>'
        f'<thead><tr>{top}</tr></thead><tbody>{"".join(lines[:LISTED])}</tbody></table>{rest}'
    )


def notes(verdict: Verdict) -> list[str]:
    """Return how it was compared, and what could not be."""
    alone = [
        f'{topic.topic}: {topic.unmatched[0]} recorded messages without a replayed one, '
        f'{topic.unmatched[1]} replayed without a recorded one; they are not compared.'
        for topic in verdict.topics
        if any(topic.unmatched)
    ]
    return [METHOD, *alone]


def caption(decision: Decision, verdict: Verdict) -> str:
    """Return what a picture shows, and where the first change is."""
    lines = 'Wide: as recorded. Thin: as the nodes answer now.'
    if decision.first is None:
        return f'{lines} They agree.'
    at = verdict.seconds(int(decision.keys[decision.first]))
    return f'{lines} The first change is at {at:.2f} s.'


def picture(decision: Decision, verdict: Verdict) -> Figure:
    """Return a decision over time, recorded and replayed."""
    figure = blank()
    rows = np.arange(len(decision.keys))
    rows = rows[:: max(1, len(rows) // MOST)]
    time = (decision.keys[rows] - verdict.start_ns) * 1e-9
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


def facts(told: Mapping[str, str]) -> dict[str, str]:
    """Return where the recording comes from."""
    names = ('vehicle', 'scenario', 'strategy', 'seed', 'time', 'created', 'commit', 'platform')
    known = {name: told[name] for name in names if name in told}
    return known or {'recording': 'tells nothing of its origin'}


def commands(order: Order) -> dict[str, str]:
    """Return how to replay it again, and how to go on."""
    words: list[str | Path] = [
        'replay',
        near(order.bag),
        '--nodes',
        ','.join(order.nodes),
        '--against',
    ]
    for node, given in order.settings.items():
        for name, value in given.items():
            words += ['--set', f'{node}.{name}={value}']
    return {
        'Replay it again': typed(*words),
        'See the recording': typed('report', near(order.bag)),
    }
