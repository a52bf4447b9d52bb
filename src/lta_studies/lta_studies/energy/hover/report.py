"""Build the report of a hover comparison."""

from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_report.drawing import build_line_trace, create_figure, EndLabel, label_ends, padded_range
from lta_report.formatting import format_number, MISSING, Tile
from lta_report.palette import ESTIMATE, SETPOINT, SOFT, TRUTH
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_studies.energy import paper
from lta_studies.energy.hover.discharge import DischargeTrace
from lta_studies.energy.hover.run import HoverComparison, HoverResult
from lta_vehicle.figures.thrust_envelope import NOMINAL
from plotly.graph_objects import Figure

CAPTION: Final = (
    'Cell voltage under load. Full: flown in the closed loop. Dashed: the same cell at '
    'constant power: the value that the paper (Huang et al. 2025) states for its drone, and '
    'three times that for a standard drone ("almost one third"). A line ends where the '
    'supply fails.'
)
CHARGE: Final = 'True state of charge of the same cells.'


def build_report(result: HoverComparison) -> Report:
    """Return the report of a hover comparison."""
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
            Picture('voltage', 'Battery voltage', CAPTION, draw_traces(result, 'voltage')),
            Picture('charge', 'State of charge', CHARGE, draw_traces(result, 'charge')),
            build_discharge_table(result),
            TextSection('Meaning and method', describe_differences(result), printed=True),
        ),
        data=to_json(result),
        facts={'vehicles': f'{result.first.name}, {result.second.name}'},
        commands={'Power of the other tasks': format_lta_command('energy', 'budget')},
    )


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


def build_discharge_table(result: HoverComparison) -> TextTable:
    """Return the table of the plotted lines."""
    heads = ('load', 'power [mW]', 'drop [V]', 'at the end [V]', 'charge left [%]',
             'failed after [s]', 'of the multirotor [%]')  # fmt: skip
    rows = [
        format_discharge_row(each.name, each.trace, each.power, result)
        for each in (result.first, result.second)
    ]
    for power, (name, trace) in zip(
        (paper.HOVER, paper.STANDARD), result.paper.items(), strict=True
    ):
        rows.append(format_discharge_row(name, trace, power, result))
    return TextTable(f'{result.seconds:.0f} s of hovering', heads, rows)


def format_discharge_row(
    name: str, trace: DischargeTrace, power: float, result: HoverComparison
) -> list[str]:
    """Return one row of the table."""
    failed = MISSING if trace.failed is None else format_number(trace.failed, 0)
    return [
        name, format_number(power, 0, 1e3), format_number(trace.voltage_drop),
        format_number(float(trace.voltage[-1])),
        format_number(float(trace.charge[-1]), 0, 100.0), failed,
        format_number(power / result.second.power, 0, 100.0),
    ]  # fmt: skip


def describe_differences(result: HoverComparison) -> list[str]:
    """Return notes on the differences to the paper."""
    first, second = result.first, result.second
    control = first.power - first.still - first.radio
    notes = [
        f'{first.name} hovers with {1e3 * first.power:.0f} mW: {1e3 * first.still:.0f} mW for its '
        'electronics and the thrust that carries its weight, as in lta vehicle show, '
        f'{1e3 * first.radio:.0f} mW for the radio, and {1e3 * control:.0f} mW for the motors '
        'that hold height and heading. How long a full cell lasts is its capacity at '
        f'{NOMINAL:g} V over this power.',
        '"Almost one third": the 1333 mW of the paper are '
        f'{100 * paper.HOVER / second.power:.0f} % of the power of {second.name} by the '
        f'bench data of Bitcraze, and our value is {100.0 * result.power_ratio:.0f} %. One '
        f'third corresponds to a standard drone of {paper.STANDARD:.1f} W.',
        'As in the figure of the paper, the cell voltage of the drone hardly drops and that '
        'of the multirotor drops steadily. The paper does not print the values of that '
        'figure.',
    ]
    if second.trace.failed is not None:
        notes.append(
            f'With the battery cell of {result.first.name}, the power supply of {second.name} '
            f'fails after {second.trace.failed:.0f} s of the {result.seconds:.0f} s. A standard '
            "drone that lasted the paper's 450 s used less power or had a larger cell."
        )
    return notes


def draw_traces(result: HoverComparison, key: str) -> Figure:
    """Plot voltage or charge over time."""
    figure = create_figure()
    unit, factor = ('V', 1.0) if key == 'voltage' else ('%', 100.0)
    traces = {result.first.name: result.first.trace, result.second.name: result.second.trace}
    # In the order of the traces: both flights, then the paper's two powers
    looks = [(TRUTH, 'solid'), (ESTIMATE, 'solid'), (TRUTH, '4px,3px'), (SETPOINT, '4px,3px')]
    labels, lines = [], []
    for (name, trace), (colour, dash) in zip(
        (traces | dict(result.paper)).items(), looks, strict=True
    ):
        values = factor * getattr(trace, key)
        lines.append(values)
        figure.add_trace(
            build_line_trace(name, trace.time, values, colour, unit=unit, dash=dash, width=1.4)
        )
        # A line that ends early is labelled at its end, the others at the right margin.
        if trace.failed is None:
            labels.append(EndLabel(name, float(values[-1]), colour))
        else:
            figure.add_annotation(
                x=trace.failed, y=float(values[-1]), xanchor='right', xshift=-8,
                text=f'{name}: fails', font={'size': 11, 'color': colour},
            )  # fmt: skip
    label_ends(figure, labels, padded_range(*lines))
    figure.update_layout(margin={'r': 130})
    figure.update_xaxes(title_text='time [s]', range=[0.0, result.seconds])
    words = 'voltage' if key == 'voltage' else 'state of charge'
    return figure.update_yaxes(title_text=f'{words} [{unit}]', title_font={'color': SOFT})


def to_json(result: HoverComparison) -> dict[str, Any]:
    """Convert the comparison to JSON, in SI units."""
    return {
        'seconds': result.seconds,
        'share': result.power_ratio,
        'flown': {each.name: _hover_to_json(each) for each in (result.first, result.second)},
        'paper': {name: _trace_to_json(trace) for name, trace in result.paper.items()},
    }


def _hover_to_json(each: HoverResult) -> dict[str, Any]:
    return {
        'power': each.power, 'energy': each.energy, 'endurance': each.endurance,
        **_trace_to_json(each.trace),
    }  # fmt: skip


def _trace_to_json(trace: DischargeTrace) -> dict[str, Any]:
    return {
        'drop': trace.voltage_drop, 'voltage': float(trace.voltage[-1]),
        'charge': float(trace.charge[-1]), 'failed': trace.failed,
    }  # fmt: skip
