"""Build the report of a hover comparison."""

from typing import Final, NamedTuple

from lta_config.command_line import format_lta_command
from lta_report.charts import ChartAxis, Curve, DASHED, draw_curves
from lta_report.drawing import decimate_line
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, SETPOINT, TRUTH
from lta_report.report import Picture, Report, TextSection
from lta_report.result_table import build_table, Column, to_record
from lta_studies.energy import paper
from lta_studies.energy.hover.run import DischargeTrace, HoverComparison
from lta_vehicle.figures.thrust_envelope import NOMINAL
from plotly.graph_objects import Figure

VOLTAGE_CAPTION: Final = (
    'Cell voltage under load. Full: flown in the closed loop. Dashed: the same cell at '
    'constant power: the value that the paper (Huang et al. 2025) states for its drone, and '
    'three times that for a standard drone ("almost one third"). A line ends where the '
    'supply fails.'
)
CHARGE_CAPTION: Final = 'True state of charge of the same cells.'


def build_report(result: HoverComparison) -> Report:
    """Return the report of a hover comparison."""
    rows = list_rows(result)
    share: Column[HoverRow] = Column(
        '', 'of the multirotor', '%', 0, lambda row: row.power / result.second.power
    )
    return Report(
        command='energy hover',
        subject=f'{result.first.name} and {result.second.name}',
        headline=format_headline(result),
        introduction=(
            f'Both drones hover in still air for {result.seconds:.0f} s, each with the same '
            'cell, full at the start.'
        ),
        tiles=build_tiles(result),
        blocks=(
            Picture('voltage', 'Battery voltage', VOLTAGE_CAPTION, draw_traces(result, 'voltage')),
            Picture('charge', 'State of charge', CHARGE_CAPTION, draw_traces(result, 'charge')),
            build_table(f'{result.seconds:.0f} s of hovering', (*HOVER_COLUMNS, share), rows),
            TextSection('Meaning and method', describe_powers(result), printed=True),
        ),
        data={
            'seconds': result.seconds,
            'share': result.power_ratio,
            'flown': {
                each.name: {
                    'power': each.power, 'energy': each.energy, 'endurance': each.endurance,
                    **to_record(HOVER_COLUMNS, row),
                }
                for each, row in zip((result.first, result.second), rows, strict=False)
            },
            'paper': {row.name: to_record(HOVER_COLUMNS, row) for row in rows[2:]},
        },
        facts={'vehicles': f'{result.first.name}, {result.second.name}'},
        commands={
            'Power of the other tasks': format_lta_command('energy', 'budget'),
            "Judge the paper's claims": format_lta_command('reproduce', 'energy'),
        },
    )  # fmt: skip


def format_headline(result: HoverComparison) -> str:
    """Return the headline."""
    first, second = result.first, result.second
    end = second.trace.failed
    lost = (
        f'loses power after {end:.0f} s'
        if end is not None
        else f'loses {second.trace.voltage_drop:.2f} V'
    )
    return (
        f'{first.name} hovers for {format_duration(first.endurance)} on a full cell. It loses '
        f'{first.trace.voltage_drop:.2f} V of cell voltage in {result.seconds:.0f} s of hovering; '
        f'{second.name} {lost} on the same cell.'
    )


def format_duration(seconds: float) -> str:
    """Return a time in minutes, or in hours from two hours on."""
    minutes = seconds / 60.0
    return f'{minutes:.0f} min' if minutes < 120.0 else f'{minutes / 60.0:.1f} h'


def build_tiles(result: HoverComparison) -> list[Tile]:
    """Return tiles with power and charge of both drones, and the power ratio."""
    tiles = []
    for each in (result.first, result.second):
        left = (
            f'{format_duration(each.endurance)} on a full cell; '
            f'{100 * float(each.trace.charge[-1]):.0f} % left'
        )
        # A drone that failed early has its charge at that time.
        when = '' if each.trace.failed is None else f' after {each.trace.failed:.0f} s'
        tiles.append(Tile(each.name, f'{each.power:.2f}', 'W', left + when))
    note = f'of the power of {result.second.name}; paper: almost a third'
    return [*tiles, Tile('power when hovering', f'{100 * result.power_ratio:.0f}', '%', note)]


class HoverRow(NamedTuple):
    """A discharge of the cell: flown, or at a power of the paper. [W]"""

    name: str
    power: float
    trace: DischargeTrace


HOVER_COLUMNS: Final[tuple[Column[HoverRow], ...]] = (
    Column('', 'load', of=lambda row: row.name),
    Column('', 'power', 'mW', 0, lambda row: row.power),
    Column('drop', 'drop', 'V', 2, lambda row: row.trace.voltage_drop),
    Column('voltage', 'at the end', 'V', 2, lambda row: float(row.trace.voltage[-1])),
    Column('charge', 'charge left', '%', 0, lambda row: float(row.trace.charge[-1])),
    Column('failed', 'failed after', 's', 0, lambda row: row.trace.failed),
)


def list_rows(result: HoverComparison) -> list[HoverRow]:
    """Return both flights, then the cell at the powers of the paper."""
    powers = (paper.HOVER, paper.STANDARD)
    return [
        *(HoverRow(each.name, each.power, each.trace) for each in (result.first, result.second)),
        *(
            HoverRow(name, power, trace)
            for power, (name, trace) in zip(powers, result.paper.items(), strict=True)
        ),
    ]


def describe_powers(result: HoverComparison) -> list[str]:
    """Return what makes up the power, and whether a supply failed."""
    first, second = result.first, result.second
    control = first.power - first.still - first.radio
    notes = [
        f'{first.name} hovers with {1e3 * first.power:.0f} mW: {1e3 * first.still:.0f} mW for its '
        'electronics and the thrust that carries its weight, as in lta vehicle show, '
        f'{1e3 * first.radio:.0f} mW for the radio, and {1e3 * control:.0f} mW for the motors '
        'that hold height and heading. How long a full cell lasts is its capacity at '
        f'{NOMINAL:g} V over this power.',
    ]
    if second.trace.failed is not None:
        notes.append(
            f'With the battery cell of {result.first.name}, the power supply of {second.name} '
            f'fails after {second.trace.failed:.0f} s of the {result.seconds:.0f} s.'
        )
    return notes


def draw_traces(result: HoverComparison, key: str) -> Figure:
    """Plot voltage or charge over time."""
    words, unit, factor = (
        ('voltage', 'V', 1.0) if key == 'voltage' else ('state of charge', '%', 100.0)
    )
    # In the order of the rows: both flights, then the paper's two powers
    looks = [(TRUTH, 'solid'), (ESTIMATE, 'solid'), (TRUTH, DASHED), (SETPOINT, DASHED)]
    curves, ends = [], []
    for row, (colour, dash) in zip(list_rows(result), looks, strict=True):
        time, values = decimate_line(row.trace.time, factor * getattr(row.trace, key))
        # A line that ends early is labelled at its end, the others at the right margin
        label = row.name if row.trace.failed is None else None
        hover = f'%{{y:.3~f}} {unit}'
        curves.append(
            Curve(row.name, time, values, colour, hover, 'lines', dash, 1.4, label=label)
        )
        if label is None:
            ends.append((row.trace.failed, float(values[-1]), row.name, colour))
    time_axis = ChartAxis('time [s]', range=(0.0, result.seconds))
    figure = draw_curves(curves, time_axis, ChartAxis(f'{words} [{unit}]'))
    for x, y, name, colour in ends:
        figure.add_annotation(
            x=x, y=y, xanchor='right', xshift=-8, text=f'{name}: fails',
            font={'size': 11, 'color': colour},
        )  # fmt: skip
    return figure.update_layout(margin={'r': 130})
