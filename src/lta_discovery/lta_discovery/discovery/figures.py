"""Draw a discovery: errors of forecasts, and the force that stays unexplained."""

from collections.abc import Iterator
from typing import Final

from lta_discovery.discovery.study import CALIBRATED, Discovery, FILE, NAMED, TUNED
from lta_discovery.error_picture import draw_errors, draw_errors_along
from lta_discovery.flights.measured_flight import MeasuredFlight, PERIOD
from lta_discovery.model.quaternions import quaternion_exponential, quaternion_product
from lta_discovery.state_filter.forecasts import FlightForecasts
from lta_model.effects.protocol import AXES
from lta_report.drawing import add_legend, create_figure
from lta_report.palette import ESTIMATE, TRUTH
from lta_report.report import Block, Picture, ReportSection
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

THIN: Final = 5  # grid points from one drawn sample to the next, 0.2 s


def build_forecast_picture(study: Discovery) -> Picture:
    """Return the figure of the errors by horizon."""
    scores = study.comparison.scores
    where = 'held-out flights' if study.held_out else 'flights that the search has seen'
    return draw_errors(
        [one.horizon for one in scores],
        {name: [one.errors[name].position for one in scores] for name in scores[0].errors},
        f'RMS over all forecasts of {where}.',
    )


def build_pictures(study: Discovery) -> Iterator[Block]:
    """Yield forecasts along the first judged flight, and what stays unexplained in each flight."""
    comparison = study.comparison
    if comparison.scores:
        best = (NAMED, CALIBRATED, TUNED)
        last = next(name for name in best if name in comparison.forecasts)
        horizon = comparison.main.horizon if comparison.main else comparison.scores[0].horizon
        models = {name: comparison.forecasts[name][0] for name in (FILE, last)}
        yield draw_errors_along(comparison.names[0], models, horizon)
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
    figure = add_legend(create_figure(len(AXES)))
    thin = slice(None, None, THIN)
    for row, axis in enumerate(AXES, start=1):
        for model, wrench in wrenches.items():
            figure.add_scatter(
                x=flight.time[thin], y=1e3 * wrench[thin, row - 1], name=model,
                line={'color': ESTIMATE if model == TUNED else TRUTH}, legendgroup=model,
                showlegend=row == 1, row=row, col=1,
            )  # fmt: skip
        unit = 'mN' if row < 4 else 'mN m'
        figure.update_yaxes(title=f'{axis} [{unit}]', nticks=4, row=row, col=1)
    figure.update_xaxes(title='time [s]', row=6, col=1)
    caption = (
        f'{name}: force and moment that the model of the vehicle does not explain, as the '
        'smoother estimates them from all readings.'
    )
    return Picture(title, 'Where the model is off', caption, figure, height=840)
