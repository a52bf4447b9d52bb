"""Draw forecast errors by the time ahead, and along a flight."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_discovery.state_filter.forecasts import FlightForecasts
from lta_report.drawing import add_legend, create_figure
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, TRUTH, WALL
from lta_report.report import Picture

# By the name of the model
COLOURS: Final = {
    'coasting': WALL,
    'vehicle file': ESTIMATE,
    'calibrated': SETPOINT,
    'calibrated.yaml': SETPOINT,
    'tolerances fitted': LAMP,
    'with what is named': TRUTH,
    'vehicle.yaml': GOOD,
}
TICKS: Final = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500]  # cm
PLOT_AXES: Final = ('x', 'y', 'z')


def draw_errors(
    horizons: Sequence[float], errors: Mapping[str, Sequence[float]], caption: str
) -> Picture:
    """
    Return the position errors of some models by the time ahead.

    `errors`: of each model at each horizon. [m]
    """
    figure = add_legend(create_figure())
    for name, values in errors.items():
        figure.add_scatter(
            x=list(horizons), y=[100.0 * one for one in values], name=name, mode='lines+markers',
            line={'color': COLOURS[name]},
        )  # fmt: skip
    figure.update_xaxes(title='time ahead [s]')
    figure.update_yaxes(title='position error [cm]', type='log', tickvals=TICKS)
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
