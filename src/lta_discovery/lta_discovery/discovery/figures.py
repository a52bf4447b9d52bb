"""Draw a discovery: errors of forecasts, forecasts along a flight, and the unexplained force."""

from collections.abc import Iterator
from typing import Final

from lta_discovery.discovery.forecast_comparison import COASTING
from lta_discovery.discovery.study import CALIBRATED, Discovery, FILE, NAMED, TUNED, WRITTEN
from lta_discovery.flights.measured_flight import MeasuredFlight, PERIOD
from lta_discovery.model.quaternions import quaternion_exponential, quaternion_product
from lta_discovery.state_filter.forecasts import FlightForecasts
from lta_model.effects.protocol import AXES
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, TRUTH, WALL
from lta_report.report import Block, Picture, ReportSection
import numpy as np
from numpy.typing import NDArray
import plotly.graph_objects as go
from plotly.subplots import make_subplots

Array = NDArray[np.float64]

COLOURS: Final = {
    COASTING: WALL,
    FILE: ESTIMATE,
    CALIBRATED: SETPOINT,
    TUNED: LAMP,
    NAMED: TRUTH,
    WRITTEN: GOOD,
}
TICKS: Final = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500]  # cm
SIDES: Final = ('x [m]', 'y [m]', 'z [m]')
THIN: Final = 5  # grid points from one drawn sample to the next, 0.2 s


def build_forecast_picture(study: Discovery) -> Picture:
    """Return the figure of the errors by horizon."""
    figure, scores = go.Figure(), study.comparison.scores
    for name in scores[0].errors if scores else ():
        figure.add_scatter(
            x=[one.horizon for one in scores],
            y=[100.0 * one.errors[name].position for one in scores],
            name=name, mode='lines+markers', line={'color': COLOURS[name]},
        )  # fmt: skip
    figure.update_xaxes(title='time ahead [s]')
    figure.update_yaxes(title='position error [cm]', type='log', tickvals=TICKS)
    where = 'held-out flights' if study.held_out else 'flights that the search has seen'
    return Picture('errors', 'Forecast errors', f'RMS over all forecasts of {where}.', figure)


def build_pictures(study: Discovery) -> Iterator[Block]:
    """Yield forecasts along the first judged flight, and what stays unexplained in each flight."""
    comparison = study.comparison
    if comparison.scores:
        best = (NAMED, CALIBRATED, TUNED)
        last = next(name for name in best if name in comparison.forecasts)
        yield _draw_forecasts(
            comparison.names[0],
            comparison.flights[0],
            {name: comparison.forecasts[name][0] for name in (FILE, last)},
            comparison.main.horizon if comparison.main else 0.0,
        )
    wrenches = [
        _draw_wrench(
            f'wrench_{k}',
            name,
            study.flights[name][1],
            {
                TUNED: study.missing.bare_wrenches[k],
                NAMED if study.named else TUNED: study.missing.wrenches[k],
            },
        )
        for k, name in enumerate(study.learned_from)
    ]
    yield wrenches[0]
    if wrenches[1:]:
        yield ReportSection('Unexplained force in the other flights', wrenches[1:], folded=True)


def _draw_forecasts(
    name: str, flight: MeasuredFlight, models: dict[str, FlightForecasts], horizon: float
) -> Picture:
    """Return the position of a flight as measured, and as forecast some seconds before."""
    figure = make_subplots(rows=3, cols=1, shared_xaxes=True, vertical_spacing=0.04)
    thin = slice(None, None, THIN)
    for row, side in enumerate(SIDES, start=1):
        figure.add_scatter(
            x=flight.time[thin], y=flight.position[thin, row - 1], name='measured',
            line={'color': WALL, 'width': 4}, legendgroup='measured', showlegend=row == 1,
            row=row, col=1,
        )  # fmt: skip
        for model, forecasts in models.items():
            time, place = predict_positions(flight, forecasts, horizon)
            figure.add_scatter(
                x=time, y=place[:, row - 1], name=model, mode='lines+markers',
                line={'color': COLOURS[model]}, marker={'size': 4}, legendgroup=model,
                showlegend=row == 1, row=row, col=1,
            )  # fmt: skip
        figure.update_yaxes(title=side, row=row, col=1)
    figure.update_xaxes(title='time [s]', row=3, col=1)
    caption = (
        f'{name}: measured position, and where each model expected the vehicle {horizon:g} s '
        'before.'
    )
    return Picture('flight', 'Forecasts along a flight', caption, figure, height=560)


def predict_positions(
    flight: MeasuredFlight, forecasts: FlightForecasts, horizon: float
) -> tuple[Array, Array]:
    """Return times and positions that were forecast some seconds before, NaN where diverged."""
    time, poses = predict_poses(flight, forecasts, horizon)
    return time, poses[:, :3]


def predict_poses(
    flight: MeasuredFlight, forecasts: FlightForecasts, horizon: float
) -> tuple[Array, Array]:
    """Return times, shape (S,), and the poses forecast for them, shape (S, 7) [m]."""
    h = forecasts.horizons.index(horizon)
    at = np.rint((forecasts.starts + horizon - flight.time[0]) / PERIOD).astype(np.int64)
    inside = at < len(flight.time)
    at, errors = at[inside], forecasts.errors[inside, h]
    errors = np.where(np.isfinite(errors), errors, np.nan)
    # An error is from the forecast pose to the measured one, a rotation in the body
    turn = quaternion_product(flight.quaternion[at], quaternion_exponential(-errors[:, 3:]))
    return flight.time[at], np.column_stack([flight.position[at] - errors[:, :3], turn])


def _draw_wrench(
    title: str, name: str, flight: MeasuredFlight, wrenches: dict[str, Array]
) -> Picture:
    """Return the force and moment that a model leaves unexplained in a flight."""
    figure = make_subplots(rows=6, cols=1, shared_xaxes=True, vertical_spacing=0.02)
    thin = slice(None, None, THIN)
    for row, axis in enumerate(AXES, start=1):
        for model, wrench in wrenches.items():
            figure.add_scatter(
                x=flight.time[thin], y=1e3 * wrench[thin, row - 1], name=model,
                line={'color': ESTIMATE if model == TUNED else TRUTH}, legendgroup=model,
                showlegend=row == 1, row=row, col=1,
            )  # fmt: skip
        unit = 'mN' if row < 4 else 'mN m'
        figure.update_yaxes(title=f'{axis}<br>[{unit}]', row=row, col=1)
    figure.update_xaxes(title='time [s]', row=6, col=1)
    caption = (
        f'{name}: force and moment that the model of the vehicle does not explain, as the '
        'smoother estimates them from all readings.'
    )
    return Picture(title, 'Where the model is off', caption, figure, height=720)
