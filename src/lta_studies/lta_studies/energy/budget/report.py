"""Build the report of a power budget."""

from typing import Final

from lta_config.command_line import format_lta_command
from lta_model.electrical.loads import BENCH, power_at_duty
from lta_report.drawing import add_legend, create_figure, EndLabel, label_ends
from lta_report.formatting import format_number, MISSING, Tile
from lta_report.palette import ESTIMATE, GOOD, INK, LAMP, RAW, SOFT, TRUTH
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_studies.energy import paper
from lta_studies.energy.budget.run import format_paper_values, PowerBudget, to_json
import numpy as np
from plotly.graph_objects import Bar, Figure, Scatter

TO: Final = '\N{EN DASH}'
VOLTAGES: Final = ((4.2, TRUTH), (3.7, GOOD), (3.3, ESTIMATE))  # V, full to nearly empty
TASKS: Final = (
    'Bars: mean power over the seeds, for electronics and rotors. Diamonds: values of the '
    'paper (Huang et al. 2025): 1523 to 1544 mW for navigating by any strategy, and 3 x '
    '1333 mW for a standard drone, because the paper says that its drone needs "almost one '
    'third" of that.'
)
MOTORS: Final = (
    'Lines: power of one rotor at three cell voltages. The thrust depends on the mean '
    "voltage at the motor, and the power is affine in thrust. Dots: Bitcraze's bench data "
    '(16 rows) without the electronics. Their supply voltage dropped from 4.0 to 3.3 V with '
    'load, so the dots move from line to line.'
)


def build_report(result: PowerBudget) -> Report:
    """Return the report of a power budget."""
    return Report(
        command='energy budget',
        subject=result.vehicle,
        headline=format_headline(result),
        introduction=(
            'Power of each task in simulated flights, compared with the paper (Huang et al. 2025).'
        ),
        tiles=build_tiles(result),
        blocks=(
            Picture('tasks', 'Power by task', TASKS, draw_task_power(result)),
            Picture(
                'motors', 'Power of one rotor by duty and voltage', MOTORS,
                draw_rotor_power(result),
            ),
            build_task_table(result),
            build_cause_table(result),
            TextSection('Meaning and method', describe_differences(result), printed=True),
        ),
        data=to_json(result),
        facts={
            'vehicle': result.vehicle,
            'compared with': result.standard,
        },
        commands={'Hover on one battery cell': format_lta_command('energy', 'hover')},
    )  # fmt: skip


def format_headline(result: PowerBudget) -> str:
    """Return the headline."""
    hover = result.tasks['hovering'].power
    return (
        f'Hovering takes {1e3 * hover:.0f} mW, {100.0 * result.hover_power_ratio:.0f} % of '
        f'the power of a {result.standard}; the paper states {1e3 * paper.HOVER:.0f} mW, '
        '"almost one third".'
    )


def build_tiles(result: PowerBudget) -> list[Tile]:
    """Return tiles for the tasks in flight and for the multirotor."""
    tiles = []
    for name, task in result.tasks.items():
        if task.rotors > 0.0:
            words = TO.join(format_paper_values(task))
            note = f'paper: {words} mW' if words else 'not in the paper'
            tiles.append(Tile(name, f'{1e3 * task.power:.0f}', 'mW', note))
    note = f'paper: 3 x {1e3 * paper.HOVER:.0f} mW'
    return [*tiles, Tile(f'{result.standard}, hovering', f'{result.hover.power:.2f}', 'W', note)]


def build_task_table(result: PowerBudget) -> TextTable:
    """Return the table of tasks, compared with the paper."""
    heads = ('task', 'seconds', 'electronics [mW]', 'rotors [mW]', 'total [mW]', 'paper [mW]',
             'ours / paper')  # fmt: skip
    rows = []
    for name, each in {**result.tasks, f'{result.standard}, hovering': result.hover}.items():
        words = (
            format_paper_values(each)
            if each is not result.hover
            else [f'{1e3 * paper.STANDARD:.0f}']
        )
        # Of a range in the paper, its middle is compared.
        mean = sum(map(float, words)) / len(words) if words else None
        # The two ground tasks have no duration; NaN differs from itself.
        rows.append([
            name,
            format_number(None if each.seconds != each.seconds else each.seconds, 1),
            format_number(each.electronics, 0, 1e3),
            f'{format_number(each.rotors, 0, 1e3)}\N{PLUS-MINUS SIGN}'
            f'{format_number(each.off, 0, 1e3)}'
            if each.rotors else '0',
            format_number(each.power, 0, 1e3),
            TO.join(words) or MISSING,
            format_number(1e3 * each.power / mean) if mean else MISSING,
        ])  # fmt: skip
    return TextTable('Power by task, compared with the paper', heads, rows)


def build_cause_table(result: PowerBudget) -> TextTable:
    """Return the table of causes that could explain the paper's hover power."""
    cause = result.causes
    rows = [
        [
            'hovering with ideal rotors',
            f'{format_number(cause.least, 0, 1e3)} mW',
            'in still air',
        ],
        [
            'or heavier',
            f'{format_number(cause.heaviness, 1, 1e3)} g',
            'net weight in air, instead of 2 g',
        ],
        ['or against a draught', f'{format_number(cause.wind)} m/s', 'holding its position'],
        [
            'or worse rotors',
            f'{format_number(cause.factor, 1)} times',
            'the power at the same thrust',
        ],
    ]
    note = (
        'Each cause alone would raise our hover power to 1333 mW. The paper does not state '
        'the weight, the draught or the rotors of its measurement.'
    )
    return TextTable('Possible causes of 1333 mW', ('cause', 'amount', ''), rows, note)


def describe_differences(result: PowerBudget) -> list[str]:
    """Return notes on the differences to the paper."""
    cruise, share = result.tasks['flying at 0.5 m/s'], result.hover_power_ratio
    return [
        f'"Almost one third": 3 x 1333 mW would be a standard drone of {paper.STANDARD:.1f} '
        "W. According to Bitcraze's bench data a Crazyflie of 27 g takes "
        f'{result.hover.power:.1f} W. The 1333 mW are '
        f'{100.0 * paper.HOVER / result.hover.power:.0f} % of that, and our '
        f'{1e3 * result.tasks["hovering"].power:.0f} mW are {100.0 * share:.0f} %. If the '
        'standard drone is a Crazyflie, buoyancy saves more than the paper states.',
        "Navigation: the paper's strategies take 190 to 211 mW more than hovering, which is "
        'assigned here to the light board and the computing. Flying at 0.5 m/s against drag '
        f'takes another {1e3 * (cruise.power - result.tasks["hovering"].power):.0f} mW with '
        'these rotors. The value of the paper does not include this; ours includes both, '
        'and the turns.',
        'The powers for idling and transmitting are taken from the paper. Rotor power is '
        "affine in thrust, fitted to Bitcraze's bench data; the rotors of the paper may be "
        'better or worse.',
    ]


def draw_task_power(result: PowerBudget) -> Figure:
    """Plot a bar for each task, and the paper's values."""
    figure = create_figure()
    every = {**result.tasks, f'{result.standard}, hovering': result.hover}
    names = list(every)
    for key, colour in (('electronics', RAW), ('rotors', TRUTH)):
        figure.add_trace(
            Bar(
                y=names, x=[1e3 * getattr(each, key) for each in every.values()], name=key,
                marker={'color': colour}, orientation='h', hovertemplate='%{x:.0f} mW',
            )
        )  # fmt: skip
    marks = [
        (name, float(word))
        for name, each in result.tasks.items()
        for word in format_paper_values(each)
    ]
    marks.append((names[-1], 1e3 * paper.STANDARD))
    figure.add_trace(
        Scatter(
            y=[name for name, _ in marks], x=[power for _, power in marks], mode='markers',
            name='paper', marker={'color': ESTIMATE, 'size': 9, 'symbol': 'diamond'},
            hovertemplate='paper %{x:.0f} mW',
        )
    )  # fmt: skip
    for name, each in every.items():
        figure.add_annotation(
            y=name, x=1e3 * each.power, xanchor='left', xshift=6, text=f'{1e3 * each.power:.0f}',
            font={'color': INK, 'size': 11},
        )  # fmt: skip
    add_legend(figure).update_layout(barmode='stack', bargap=0.35, hovermode='closest')
    figure.update_xaxes(title_text='power [mW]', rangemode='tozero')
    return figure.update_yaxes(automargin=True, autorange='reversed')


def draw_rotor_power(result: PowerBudget) -> Figure:
    """Plot the power of a rotor by duty at several voltages, and the bench data."""
    figure = create_figure()
    duty = np.linspace(0.0, 1.0, 101)
    loads, labels = result.loads, []
    for voltage, colour in VOLTAGES:
        power = [
            power_at_duty(each, voltage, loads.rotor_offset, loads.rotor_slope)
            for each in duty.tolist()
        ]
        figure.add_trace(
            Scatter(x=duty, y=power, mode='lines', name=f'{voltage} V',
                    line={'color': colour, 'width': 1.6}, hovertemplate='%{y:.2f} W')
        )  # fmt: skip
        labels.append(EndLabel(f'{voltage} V', power[-1], colour))
    idle = BENCH[0].power
    figure.add_trace(
        Scatter(
            x=[row.duty for row in BENCH],
            # The bench data are for four rotors, including the electronics (row 0).
            y=[(row.power - idle) / 4.0 for row in BENCH], mode='markers', name='bench',
            marker={'color': LAMP, 'size': 6},
            text=[f'{row.voltage} V' for row in BENCH],
            hovertemplate='bench data: %{y:.2f} W at %{text}',
        )
    )  # fmt: skip
    last = BENCH[-1]
    figure.add_annotation(
        x=last.duty,
        y=(last.power - idle) / 4.0,
        text='bench data',
        xanchor='right',
        xshift=-8,
        yshift=8,
        font={'color': LAMP},
    )
    label_ends(figure, labels, (0.0, 5.6))
    figure.update_xaxes(title_text='duty', title_font={'color': SOFT})
    return figure.update_yaxes(title_text='power of one rotor [W]')
