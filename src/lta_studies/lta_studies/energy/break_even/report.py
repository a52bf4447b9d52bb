"""Build the report of a break-even map."""

import math
from typing import Final

from lta_energy.harvest import HIGHEST_ILLUMINANCE, LAMPS
from lta_report.drawing import add_legend, create_figure
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, TRUTH, WALL
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_studies.energy.break_even.study import BreakEvenMap, format_klux
from plotly.graph_objects import Figure, Scatter

LIGHTS: Final = ('steady white LED light', 'flickering white LED light', 'sunlight')  # of LAMPS
COLOURS: Final = (TRUTH, ESTIMATE, LAMP, GOOD)
ABOUT: Final = (
    'Power of the solar array and its charger, from 300 lx in a warehouse to full sun, '
    'compared with the power that each task needs.'
)
OWN: Final = (
    "Charger output with the vehicle's own array, for each kind of light. Dotted: power "
    'that each task needs. In weak light the charger is off, because it would use more '
    'power than it delivers.'
)
METHOD: Final = (
    'Each panel is a single-diode model, with one string per panel and cells warmed by the '
    'light. The charger is that of the vehicle file. An array has as many panels as the '
    'mass budget allows, at least one.',
    'Luminous efficacy and the response of each cell by the spectra of the lights: 326 lm/W for '
    'white LED light, 109 lm/W for sunlight.',
    'The powers for hovering and flying are those of the paper (Huang et al. 2025); '
    '"lta energy budget" computes them from simulated flights.',
)


def build_report(result: BreakEvenMap) -> Report:
    """Return the report of a break-even map."""
    return Report(
        command='energy breakeven',
        subject=result.vehicle,
        headline=format_headline(result),
        introduction=ABOUT,
        tiles=build_tiles(result),
        blocks=(
            Picture('income', 'Power from the light', OWN, plot_charger_output(result)),
            build_illuminance_table(result),
            TextSection('Meaning and method', METHOD),
        ),
        data=result.to_json(),
        facts={'vehicle': result.vehicle},
    )


def format_headline(result: BreakEvenMap) -> str:
    """Return the headline."""
    lux = [result.break_even_lux(result.arrays[0], lamp, result.loads['idle']) for lamp in LAMPS]
    needed = [
        f'{format_klux(each)} klx of {name}'
        for each, name in zip(lux, LIGHTS, strict=True)
        if math.isfinite(each) and each <= HIGHEST_ILLUMINANCE
    ]
    if not needed:
        return f'{result.vehicle} cannot idle indefinitely at any illuminance.'
    return f'{result.vehicle} can idle indefinitely at {", or at ".join(needed)}.'


def build_tiles(result: BreakEvenMap) -> list[Tile]:
    """Return tiles with the break-even illuminance in the sun."""
    tiles = []
    for task, load in result.loads.items():
        lux = result.break_even_lux(result.arrays[0], 'sun', load)
        tiles.append(
            Tile(
                task,
                format_klux(lux),
                'klx',
                f'of sunlight give the {1e3 * load:.0f} mW that it needs',
            )
        )
    return tiles


def build_illuminance_table(result: BreakEvenMap) -> TextTable:
    """Return the illuminances as a table."""
    rows = [
        [
            f'{array.count} x {array.name}',
            f'{1e3 * array.mass:.0f}',
            lamp,
            *(
                format_klux(result.break_even_lux(array, lamp, load))
                for load in result.loads.values()
            ),
        ]
        for array in result.arrays
        for lamp in LAMPS
    ]
    heads = [
        'array', 'g', 'light',
        *(f'{task}, {1e3 * load:.0f} mW' for task, load in result.loads.items()),
    ]  # fmt: skip
    note = (
        'Illuminance on the level panel at which the charger output equals the power of the '
        'task, in kilolux. For a beacon: illuminance while it is on.'
    )
    return TextTable('Break-even [klx]', heads, rows, note)


def plot_charger_output(result: BreakEvenMap) -> Figure:
    """Plot the charger output against illuminance, with the power of the tasks."""
    figure = create_figure()
    for colour, lamp in zip(COLOURS, LAMPS, strict=False):
        lux, watts = result.sample_charger_output(result.arrays[0], lamp)
        figure.add_trace(
            Scatter(
                # A logarithmic axis cannot show zero; None leaves a gap.
                x=lux, y=[1e3 * each if each > 0.0 else None for each in watts], name=lamp,
                mode='lines', line={'color': colour, 'width': 1.6}, showlegend=True,
                hovertemplate='%{y:.0f} mW',
            )
        )  # fmt: skip
    for task, load in result.loads.items():
        figure.add_shape(
            type='line', x0=0.0, x1=1.0, xref='paper', y0=1e3 * load, y1=1e3 * load,
            layer='below', line={'color': WALL, 'width': 1, 'dash': '2px,3px'},
        )  # fmt: skip
        figure.add_annotation(
            # On a logarithmic axis annotations take the exponent, while shapes take the value.
            x=1.0, xref='paper', y=math.log10(1e3 * load), text=task, xanchor='right',
            # The lower of two close lines is labelled below, the upper one above.
            yanchor='top' if task.startswith(('idle', 'hovering')) else 'bottom',
        )  # fmt: skip
    ticks = [300, 1000, 3000, 10_000, 30_000, 100_000]
    figure.update_xaxes(
        type='log', title_text='illuminance on the level panel', tickvals=ticks,
        ticktext=['300 lx', '1 klx', '3 klx', '10 klx', '30 klx', '100 klx'],
    )  # fmt: skip
    figure.update_yaxes(type='log', title_text='charger output [mW]', dtick=1)
    add_legend(figure)
    return figure
