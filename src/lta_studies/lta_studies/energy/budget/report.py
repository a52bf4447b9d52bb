# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a power budget."""

from dataclasses import asdict
from typing import Final, NamedTuple

from lta_config.command_line import format_lta_command
from lta_model.electrical.loads import BENCH, power_at_duty
from lta_report.charts import ChartAxis, Curve, DASHED, draw_bars, draw_curves
from lta_report.drawing import decimate_line
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, RAW, SETPOINT, TRUTH
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_report.result_table import build_table, Column, to_record
from lta_studies.energy import paper
from lta_studies.energy.budget.hover import DischargeTrace, HoverComparison
from lta_studies.energy.budget.run import PowerBudget, TaskPower
from lta_vehicle.figures.thrust_envelope import NOMINAL
import numpy as np
from plotly.graph_objects import Figure

VOLTAGES: Final = ((4.2, TRUTH), (3.7, GOOD), (3.3, ESTIMATE))  # V, full to nearly empty
TASK_CAPTION: Final = (
    'Bars: mean power over the seeds, for electronics and rotors. Diamonds: values of the '
    'paper (Huang et al. 2025): 1523 to 1544 mW for navigating by any strategy, and 3 x '
    '1333 mW for a standard drone, because the paper says that its drone needs "almost one '
    'third" of that.'
)
MOTOR_CAPTION: Final = (
    'Lines: power of one rotor at three cell voltages. The thrust depends on the mean '
    "voltage at the motor, and the power is affine in thrust. Dots: Bitcraze's bench data "
    '(16 rows) without the electronics. Their supply voltage dropped from 4.0 to 3.3 V with '
    'load, so the dots move from line to line.'
)
VOLTAGE_CAPTION: Final = (
    'Cell voltage under load. Full: flown in the closed loop. Dashed: the same cell at '
    'constant power: the value that the paper (Huang et al. 2025) states for its drone, and '
    'three times that for a standard drone ("almost one third"). A line ends where the '
    'supply fails.'
)
BUDGET_METHOD: Final = (
    'The powers for idling and transmitting are taken from the paper, and navigating includes the '
    'light board and the computing, which are what the strategies of the paper take beyond '
    "hovering. Rotor power is affine in thrust, fitted to Bitcraze's bench data. Flying against "
    'drag and the turns are included here, and not in the value of the paper.'
)
POWER_COLUMN: Final[Column[TaskPower]] = Column(
    'power', 'total', 'mW', 0, paper=lambda task: task.paper
)
TASK_COLUMNS: Final[tuple[Column[TaskPower], ...]] = (
    Column('', 'task', of=lambda task: task.name),
    Column('seconds', 'seconds', digits=1),
    Column('electronics', 'electronics', 'mW', 0),
    Column('rotors'),
    Column('off'),
    Column('', 'rotors [mW]', of=lambda task: f'{1e3 * task.rotors:.0f}' + (
        f'\N{PLUS-MINUS SIGN}{1e3 * task.off:.0f}' if task.rotors else '')),
    POWER_COLUMN,
)  # fmt: skip


def build_report(result: PowerBudget, cell: HoverComparison) -> Report:
    """Return the report of a power budget, and of hovering on one cell."""
    hover = result.tasks['hovering'].power
    return Report(
        command='energy budget',
        subject=result.vehicle,
        headline=(
            f'Hovering takes {1e3 * hover:.0f} mW, {100.0 * result.hover_power_ratio:.0f} % of '
            f'the power of a {result.standard}; the paper states {1e3 * paper.HOVER:.0f} mW, '
            f'"almost one third". On a full cell it hovers for '
            f'{format_duration(cell.first.endurance)}.'
        ),
        introduction=(
            'Power of each task in simulated flights, compared with the paper (Huang et al. 2025).'
        ),
        tiles=[
            *(
                Tile(task.name, f'{1e3 * task.power:.0f}', 'mW',
                     f'paper: {POWER_COLUMN.format_paper(task)} mW' if task.paper
                     else 'not in the paper')
                for task in result.tasks.values() if task.rotors > 0.0
            ),
            Tile(result.hover.name, f'{result.hover.power:.2f}', 'W',
                 f'paper: 3 x {1e3 * paper.HOVER:.0f} mW'),
            *(
                Tile(f'{each.name}, on a full cell', format_duration(each.endurance), '',
                     f'of hovering; {100 * float(each.trace.charge[-1]):.0f} % left after '
                     f'{each.trace.failed or cell.seconds:.0f} s')
                for each in (cell.first, cell.second)
            ),
        ],
        blocks=(
            Picture('tasks', 'Power by task', TASK_CAPTION, draw_task_power(result)),
            Picture('motors', 'Power of one rotor by duty and voltage', MOTOR_CAPTION,
                    draw_rotor_power(result)),
            Picture('voltage', 'Battery voltage while hovering', VOLTAGE_CAPTION,
                    draw_voltage(cell)),
            build_task_table(result),
            build_cause_table(result),
            build_hover_table(cell),
            TextSection('Method', (BUDGET_METHOD, describe_powers(cell))),
        ),
        data={
            'vehicle': result.vehicle,
            'standard': result.standard,
            'tasks': {name: to_record(TASK_COLUMNS, task) for name, task in result.tasks.items()},
            'standard_hover': to_record(TASK_COLUMNS, result.hover),
            'share_of_standard': result.hover_power_ratio,
            'causes': asdict(result.causes),
            'on_one_cell': encode_hover(cell),
        },
        facts={'vehicle': result.vehicle, 'compared with': result.standard},
        commands={
            "Judge the paper's claims": format_lta_command('reproduce', 'energy'),
        },
    )  # fmt: skip


def build_task_table(result: PowerBudget) -> TextTable:
    """Return the table of tasks, compared with the paper."""
    tasks = [*result.tasks.values(), result.hover]
    return build_table('Power by task, compared with the paper', TASK_COLUMNS, tasks)


def build_cause_table(result: PowerBudget) -> TextTable:
    """Return the table of causes that could explain the paper's hover power."""
    cause = result.causes
    rows = [
        ['hovering with ideal rotors', f'{1e3 * cause.least:.0f} mW', 'in still air'],
        ['or heavier', f'{1e3 * cause.heaviness:.1f} g', 'net weight in air, instead of 2 g'],
        ['or against a draught', f'{cause.wind:.2f} m/s', 'holding its position'],
        ['or worse rotors', f'{cause.factor:.1f} times', 'the power at the same thrust'],
    ]
    note = (
        'Each cause alone would raise our hover power to 1333 mW. The paper does not state '
        'the weight, the draught or the rotors of its measurement.'
    )
    return TextTable('Possible causes of 1333 mW', ('cause', 'amount', ''), rows, note)


def draw_task_power(result: PowerBudget) -> Figure:
    """Plot a bar for each task, and the paper's values."""
    tasks = [*result.tasks.values(), result.hover]
    parts = {
        'electronics': ([1e3 * task.electronics for task in tasks], RAW),
        'rotors': ([1e3 * task.rotors for task in tasks], TRUTH),
    }
    figure = draw_bars([task.name for task in tasks], parts, 'power', 'mW')
    marks = [(task.name, 1e3 * power) for task in tasks for power in task.paper]
    names, powers = zip(*marks, strict=True)
    diamonds = {'marker_symbol': 'diamond'}
    curve = Curve('paper', powers, names, ESTIMATE, 'paper %{x:.0f} mW', 'markers', size=9,
                  more=diamonds)  # fmt: skip
    return figure.add_trace(curve.to_trace())


def draw_rotor_power(result: PowerBudget) -> Figure:
    """Plot the power of a rotor by duty at several voltages, and the bench data."""
    duty, loads, idle = np.linspace(0.0, 1.0, 101).tolist(), result.loads, BENCH[0].power
    curves = []
    for voltage, colour in VOLTAGES:
        power = [
            power_at_duty(each, voltage, loads.rotor_offset, loads.rotor_slope) for each in duty
        ]
        curves.append(
            Curve(f'{voltage} V', duty, power, colour, '%{y:.2f} W', label=f'{voltage} V')
        )
    # The bench data are for four rotors, including the electronics (row 0)
    bench = [(row.power - idle) / 4.0 for row in BENCH]
    words = {'text': [f'{row.voltage} V' for row in BENCH]}
    curves.append(
        Curve(
            'bench', [row.duty for row in BENCH], bench, LAMP,
            'bench data: %{y:.2f} W at %{text}', 'markers', size=6, more=words,
        )
    )  # fmt: skip
    power_axis = ChartAxis('power of one rotor [W]', range=(0.0, 5.6))
    figure = draw_curves(curves, ChartAxis('duty'), power_axis)
    return figure.add_annotation(
        x=BENCH[-1].duty, y=bench[-1], text='bench data', xanchor='right', xshift=-8, yshift=8,
        font={'color': LAMP},
    )  # fmt: skip


class HoverRow(NamedTuple):
    """A discharge of the cell: flown, or at a power of the paper [W]."""

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


def build_hover_table(result: HoverComparison) -> TextTable:
    """Return the table of hovering on one cell."""
    share: Column[HoverRow] = Column(
        '', 'of the multirotor', '%', 0, lambda row: row.power / result.second.power
    )
    heading = f'{result.seconds:.0f} s of hovering on the same cell, full at the start'
    return build_table(heading, (*HOVER_COLUMNS, share), list_rows(result))


def encode_hover(result: HoverComparison) -> dict[str, object]:
    """Return hovering on one cell as JSON, in SI units."""
    rows = list_rows(result)
    return {
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
    }  # fmt: skip


def format_duration(seconds: float) -> str:
    """Return a time in minutes, or in hours from two hours on."""
    minutes = seconds / 60.0
    return f'{minutes:.0f} min' if minutes < 120.0 else f'{minutes / 60.0:.1f} h'


def describe_powers(result: HoverComparison) -> str:
    """Return what makes up the power of hovering."""
    first = result.first
    control = first.power - first.still - first.radio
    return (
        f'{first.name} hovers with {1e3 * first.power:.0f} mW: {1e3 * first.still:.0f} mW for its '
        'electronics and the thrust that carries its weight, as in lta vehicle show, '
        f'{1e3 * first.radio:.0f} mW for the radio, and {1e3 * control:.0f} mW for the motors '
        'that hold height and heading. How long a full cell lasts is its capacity at '
        f'{NOMINAL:g} V over this power.'
    )


def draw_voltage(result: HoverComparison) -> Figure:
    """Plot the voltage of the cell over time."""
    # In the order of the rows: both flights, then the paper's two powers
    looks = [(TRUTH, 'solid'), (ESTIMATE, 'solid'), (TRUTH, DASHED), (SETPOINT, DASHED)]
    curves, ends = [], []
    for row, (colour, dash) in zip(list_rows(result), looks, strict=True):
        time, values = decimate_line(row.trace.time, row.trace.voltage)
        # A line that ends early is labelled at its end, the others at the right margin
        label = row.name if row.trace.failed is None else None
        curves.append(
            Curve(row.name, time, values, colour, '%{y:.3~f} V', 'lines', dash, 1.4, label=label)
        )
        if label is None:
            ends.append((row.trace.failed, float(values[-1]), row.name, colour))
    time_axis = ChartAxis('time [s]', range=(0.0, result.seconds))
    figure = draw_curves(curves, time_axis, ChartAxis('voltage [V]'))
    for x, y, name, colour in ends:
        figure.add_annotation(
            x=x, y=y, xanchor='right', xshift=-8, text=f'{name}: fails',
            font={'size': 11, 'color': colour},
        )  # fmt: skip
    return figure.update_layout(margin={'r': 130})
