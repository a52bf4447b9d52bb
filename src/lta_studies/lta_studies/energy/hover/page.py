"""Hovering on identical cells as one self-contained page."""

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any, Final

from lta_bridge.provenance import commit
from lta_report.drawing import blank, extent, Label, label_ends, line
from lta_report.formatting import MISSING, number, Tile
from lta_report.frame import framed, written
from lta_report.palette import ESTIMATE, SETPOINT, SOFT, TRUTH
from lta_report.pieces import section, tile_html
from lta_studies.energy import paper
from lta_studies.energy.hover.run import Comparison, Hover
from lta_studies.energy.hover.steady import Trace
from lta_studies.energy.tables import Table, table_html
from plotly.graph_objects import Figure

CAPTION: Final = (
    'Voltage of the cell under load. Full: flown in the closed loop. Dashed: the same cell under '
    'the constant power that the seed paper prints for its drone, and under thrice that, which '
    'its "almost one third" makes of a standard drone. A line ends where the supply fails.'
)
CHARGE: Final = 'State of charge of the same cells; the truth, which no meter sees.'


def write_page(found: Comparison, commands: Mapping[str, str], out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(found, commands), out)


def page(found: Comparison, commands: Mapping[str, str]) -> str:
    """Return the whole page."""
    return framed(
        'energy.html',
        title=escape(title(found)),
        kicker=escape(f'energy hover · {found.first.name} and {found.second.name}'),
        about=f'Both hover in still air on the same full cell for {found.seconds:.0f} s.',
        tiles='\n'.join(tile_html(*each) for each in tiles(found)),
        first=section('voltage', 'Battery voltage', CAPTION, picture(found, 'voltage')),
        pictures=section('charge', 'State of charge', CHARGE, picture(found, 'charge')),
        tables=table_html(table(found)),
        method=''.join(f'<p class="note">{escape(each)}</p>' for each in notes(found)),
        facts={'vehicles': f'{found.first.name}, {found.second.name}', 'commit': commit()},
        commands=commands,
    )


def title(found: Comparison) -> str:
    """Return what came out, in a sentence."""
    first, second = found.first, found.second
    end = second.trace.failed
    lost = f'falls after {end:.0f} s' if end is not None else f'drops {second.trace.drop:.2f} V'
    return (
        f'{first.name} drops {first.trace.drop:.2f} V in {found.seconds:.0f} s of hovering; '
        f'{second.name} {lost} on the same cell.'
    )


def tiles(found: Comparison) -> list[Tile]:
    """Return power and charge of both, and their share."""
    made = []
    for each in (found.first, found.second):
        left = f'{100 * float(each.trace.charge[-1]):.0f} % of the cell left'
        when = '' if each.trace.failed is None else f' after {each.trace.failed:.0f} s'
        made.append(Tile(each.name, f'{each.power:.2f}', 'W', left + when))
    note = 'of its power; paper: almost a third'
    return [*made, Tile('share', f'{100 * found.share:.0f}', '%', note)]


def table(found: Comparison) -> Table:
    """Return all lines of the picture as numbers."""
    heads = ('on the cell', 'power [mW]', 'drop [V]', 'at the end [V]', 'charge left [%]',
             'failed after [s]', 'of the multirotor [%]')  # fmt: skip
    rows = [row(each.name, each.trace, each.power, found) for each in (found.first, found.second)]
    for power, (name, trace) in zip(
        (paper.HOVER, paper.STANDARD), found.paper.items(), strict=True
    ):
        rows.append(row(name, trace, power, found))
    return Table(f'{found.seconds:.0f} s of hovering', heads, rows)


def row(name: str, trace: Trace, power: float, found: Comparison) -> list[str]:
    """Return one line of the table."""
    failed = MISSING if trace.failed is None else number(trace.failed, 0)
    return [
        name, number(power, 0, 1e3), number(trace.drop), number(float(trace.voltage[-1])),
        number(float(trace.charge[-1]), 0, 100.0), failed,
        number(power / found.second.power, 0, 100.0),
    ]  # fmt: skip


def notes(found: Comparison) -> list[str]:
    """Return what it means beside the paper."""
    second = found.second
    told = [
        f"A third: the paper's 1333 mW are {100 * paper.HOVER / second.power:.0f} % of what "
        f"{second.name} takes by Bitcraze's bench, and ours {100.0 * found.share:.0f} %; a third "
        f'would be a standard drone of {paper.STANDARD:.1f} W.',
        "As in the paper's figure, the drone's voltage hardly falls, and the other's steadily. "
        "The figure's own values are not printed, so that no number of it can be compared.",
    ]
    if second.trace.failed is not None:
        told.append(
            f"{second.name} does not last: on {found.first.name}'s cell its supply fails after "
            f'{second.trace.failed:.0f} s, short of {found.seconds:.0f} s. A standard '
            "drone that lasted the paper's 450 s took less than this one, or had a larger cell."
        )
    return told


def picture(found: Comparison, key: str) -> Figure:
    """Return voltage or charge over time."""
    figure = blank()
    unit, factor = ('V', 1.0) if key == 'voltage' else ('%', 100.0)
    traces = {found.first.name: found.first.trace, found.second.name: found.second.trace}
    looks = [(TRUTH, 'solid'), (ESTIMATE, 'solid'), (TRUTH, '4px,3px'), (SETPOINT, '4px,3px')]
    labels, lines = [], []
    for (name, trace), (colour, dash) in zip(
        (traces | dict(found.paper)).items(), looks, strict=True
    ):
        values = factor * getattr(trace, key)
        lines.append(values)
        figure.add_trace(line(name, trace.time, values, colour, unit=unit, dash=dash, width=1.4))
        if trace.failed is None:
            labels.append(Label(name, float(values[-1]), colour))
        else:
            figure.add_annotation(
                x=trace.failed, y=float(values[-1]), xanchor='right', xshift=-8,
                text=f'{name}: fails', font={'size': 11, 'color': colour},
            )  # fmt: skip
    label_ends(figure, labels, extent(*lines))
    figure.update_layout(margin={'r': 130})
    figure.update_xaxes(title_text='time [s]', range=[0.0, found.seconds])
    words = 'voltage' if key == 'voltage' else 'state of charge'
    return figure.update_yaxes(title_text=f'{words} [{unit}]', title_font={'color': SOFT})


def plain(found: Comparison) -> dict[str, Any]:
    """Return the comparison as JSON has it, in SI units."""
    return {
        'seconds': found.seconds,
        'share': found.share,
        'flown': {each.name: _hover(each) for each in (found.first, found.second)},
        'paper': {name: _trace(trace) for name, trace in found.paper.items()},
    }


def _hover(each: Hover) -> dict[str, Any]:
    return {'power': each.power, 'energy': each.energy, **_trace(each.trace)}


def _trace(trace: Trace) -> dict[str, Any]:
    return {
        'drop': trace.drop, 'voltage': float(trace.voltage[-1]),
        'charge': float(trace.charge[-1]), 'failed': trace.failed,
    }  # fmt: skip
