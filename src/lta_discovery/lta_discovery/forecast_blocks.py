# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Show the forecast errors of some models: tiles, tables and figures."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from lta_discovery.formatting import DEGREE, format_error, format_number, TO_DEG
from lta_discovery.state_filter.forecast_scores import HorizonErrors
from lta_discovery.state_filter.forecasts import FlightForecasts, FORECAST_INTERVAL
from lta_report.drawing import add_legend, create_figure
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, TRUTH, WALL
from lta_report.report import Picture, TextTable

# By the name of the model
COLOURS: Final = {
    'coasting': WALL,
    'vehicle file': ESTIMATE,
    'calibrated': SETPOINT,
    'calibrated.yaml': SETPOINT,
    'tolerances fitted': LAMP,
    'with what is named': TRUTH,
    'with what comes closest': TRUTH,
    'vehicle.yaml': GOOD,
}
PERFECT: Final = 'perfect model'
TICKS: Final = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500]  # cm
PLOT_AXES: Final = ('x', 'y', 'z')
DIRECTIONS: Final = ('nose', 'side', 'up')  # as in `ForecastRms`


def build_error_tiles(main: HorizonErrors) -> Iterator[Tile]:
    """Yield a tile with the position error of each model."""
    for name, size in main.positions.items():
        value, _, unit = format_error(size).partition(' ')
        title = name if name.endswith('.yaml') else name.capitalize()
        words = f'RMS position error {main.horizon:g} s ahead, {main.forecasts} forecasts'
        yield Tile(title, value, unit, words)
    value, _, unit = format_error(main.least.position).partition(' ')
    yield Tile(PERFECT.capitalize(), value, unit, 'what sensors and still air leave open')


def build_error_tables(
    scores: Mapping[str, Sequence[HorizonErrors]], remark: str = ''
) -> list[TextTable]:
    """
    Return the table of forecast errors, and that of position errors by direction.

    `scores`: by the role of the flights, '' for flights of one role. Nothing without forecasts.
    """
    every = [(role, one) for role, each in scores.items() for one in each]
    if not every:
        return []
    names = list(every[0][1].errors)
    whole, parts = list[list[str]](), list[list[str]]()
    for role, one in every:
        ahead = f'{role}, {one.horizon:g} s' if role else f'{one.horizon:g} s'
        sizes = [(each.position, each.attitude) for each in one.errors.values()]
        cells = [
            f'{format_error(place, 3)}, {format_number(TO_DEG * turn)}{DEGREE}'
            for place, turn in [*sizes, one.least]
        ]
        whole.append([ahead, *cells, str(one.forecasts)])
        for side in DIRECTIONS:
            errors = (getattr(each, side) for each in one.errors.values())
            parts.append([ahead, side, *(format_error(size, 3) for size in errors)])
    note = (
        f'RMS errors of position and attitude. A forecast begins every {FORECAST_INTERVAL:g} s '
        'from past readings only, and a flight tells its lift and the strength of its commands on '
        f'the way. A {PERFECT} errs by what noisy readings and the smallest force of still air '
        f'leave open. {remark}'
    ).strip()
    return [
        TextTable('Forecasts', ('ahead', *names, PERFECT, 'forecasts'), whole, note),
        TextTable(
            'Forecasts by direction', ('ahead', 'direction', *names), parts,
            'RMS position errors by the heading in which each forecast begins.', printed=False,
        ),
    ]  # fmt: skip


def draw_errors(scores: Sequence[HorizonErrors], where: str) -> Picture:
    """Return the position errors of some models by the time ahead; `where` names the flights."""
    figure = add_legend(create_figure())
    for name in scores[0].errors:
        figure.add_scatter(
            x=[one.horizon for one in scores],
            y=[100.0 * one.errors[name].position for one in scores],
            name=name, mode='lines+markers', line={'color': COLOURS[name]},
        )  # fmt: skip
    figure.add_scatter(
        x=[one.horizon for one in scores], y=[100.0 * one.least.position for one in scores],
        name=PERFECT, mode='lines', line={'color': WALL, 'dash': 'dot'},
    )  # fmt: skip
    figure.update_xaxes(title='time ahead [s]')
    figure.update_yaxes(title='position error [cm]', type='log', tickvals=TICKS)
    # Fewer forecasts reach a later horizon
    least, most = (limit(one.forecasts for one in scores) for limit in (min, max))
    number = str(most) if least == most else f'{least} to {most}'
    caption = f'RMS over {number} forecasts of {where}.'
    return Picture('errors', 'Forecast errors', caption, figure)


def draw_errors_along(name: str, models: Mapping[str, FlightForecasts], horizon: float) -> Picture:
    """Return the position errors of the forecasts of a flight, by the time they are for."""
    figure = add_legend(create_figure(len(PLOT_AXES)))
    for model, forecasts in models.items():
        h = forecasts.horizons.index(horizon)
        for row, side in enumerate(PLOT_AXES, start=1):
            figure.add_scatter(
                x=forecasts.starts + horizon, y=-100.0 * forecasts.errors[:, h, row - 1],
                name=model, mode='lines+markers', line={'color': COLOURS[model]},
                marker={'size': 4}, legendgroup=model, showlegend=row == 1, row=row, col=1,
            )  # fmt: skip
            figure.update_yaxes(title=f'{side} [cm]', row=row, col=1)
    figure.update_xaxes(title='time [s]', row=len(PLOT_AXES), col=1)
    caption = f'{name}: position forecast {horizon:g} s before less the measured one, in the map.'
    return Picture('flight', 'Forecast errors along a flight', caption, figure, height=480)
