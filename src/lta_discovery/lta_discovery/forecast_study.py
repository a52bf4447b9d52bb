# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Judge a vehicle file alone: how well it forecasts recorded flights, beside coasting.

The forecasts are those by which a calibration is judged (`state_filter.forecasts`). The filter
from which they begin needs to know how noisy the tracker is, and how large the forces that nothing
explains. These thirteen numbers are learned from the flights themselves, about the vehicle file,
and whatever the numbers that a calibration would fit (`learn_noise`), so that they tell of the
flights more than of the file. With the numbers held at a file that is far off, the filter would
take its misfit for forces that act, and forecasts would begin from poorer states: of real flights
some positions were twice as far off, and more. The noise, and the cleaning of the data, are all
that a forecast owes to later readings.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

from lta_bag.bag_folder import find_bag
from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import open_flight
from lta_discovery.calibration.prepared_flights import prepare_calibration, PreparedCalibration
from lta_discovery.flights.bags import AssignedFlight, read_bags
from lta_discovery.flights.usable_flights import CALIBRATION_TIME, select_usable_flights
from lta_discovery.forecast_blocks import build_error_tables, build_error_tiles, COLOURS
from lta_discovery.formatting import format_error
from lta_discovery.progress import DiscoverProgress
from lta_discovery.state_filter.forecast_noise import fit_forecast_noise
from lta_discovery.state_filter.forecast_scores import (
    COASTING,
    FILE_MODEL,
    find_main_score,
    HorizonErrors,
    score_forecasts,
)
from lta_discovery.state_filter.forecasts import (
    FlightForecasts,
    forecast_flights,
    list_flight_parameters,
)
from lta_discovery.state_filter.likelihood import linearize_all, ParameterPrior
from lta_discovery.state_filter.noise_fit import learn_noise
from lta_discovery.state_filter.noise_model import average_noise, NoiseModel
from lta_flight.recorded_choices import find_recorded_name
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.drawing import add_legend, create_figure
from lta_report.json_value import to_json_value
from lta_report.report import Picture, Report, TextSection
from lta_report.request import option, ReportRequest, ROBOT, StudyRun
import numpy as np

Tell = Callable[[str, float | None], None]


@final
class ForecastRequest(ReportRequest, command='simulate --forecasts', folder='forecasts'):
    """
    Judge a vehicle file by forecasts of recorded flights, beside coasting.

    A forecast begins every 1.5 s from past readings only, and its errors 1, 3 and 8 s ahead stand
    beside those of coasting (constant body velocity and rates). It needs measured poses. The
    entry `rows` of the results has a row for each forecast.
    """

    vehicle: str = option(
        "Vehicle name or file; the recorded one by default, or 'gtmab'.", default='',
        complete='vehicle',
    )  # fmt: skip
    flights: tuple[Path, ...] = option(
        'Recorded flights: bag folders, results folders or .mcap files.', default=(),
        name='commands', metavar='BAG...',
    )  # fmt: skip
    robot: str | None = ROBOT

    def run(self, run: StudyRun) -> Report:
        """Return the report of the forecasts."""
        if not self.flights:
            raise BadInput('--forecasts judges recorded flights; add --commands BAG.')
        vehicle = self.vehicle
        if not vehicle:
            recorded = open_flight(find_bag(self.flights[0]), self.robot).provenance
            vehicle = find_recorded_name(recorded, 'vehicle') or 'gtmab'
        with DiscoverProgress(run.console) as progress:
            study = study_forecasts(vehicle, self.flights, self.robot, progress.show_stage)
        return build_report(study)


@final
@dataclass(frozen=True, slots=True)
class ForecastStudy:
    """Forecasts of some flights with one vehicle file."""

    vehicle: str  # name or file
    names: tuple[str, ...]  # of the flights
    forecasts: tuple[FlightForecasts, ...]  # of each flight
    warnings: tuple[str, ...] = ()

    @property
    def scores(self) -> tuple[HorizonErrors, ...]:
        """RMS errors of all flights at each horizon."""
        return score_forecasts({FILE_MODEL: self.forecasts} if self.forecasts else {})

    def list_rows(self) -> list[dict[str, Any]]:
        """Return a row for each forecast and horizon that a measured pose judges, in SI units."""
        rows = []
        for name, flight in zip(self.names, self.forecasts, strict=True):
            both = np.concatenate([flight.errors, flight.coasting], axis=2)
            for s, h in np.argwhere(~np.isnan(both).any(axis=2)):
                error, coasting = flight.errors[s, h], flight.coasting[s, h]
                rows.append({
                    'flight': name,
                    'start_s': flight.starts[s],
                    'horizon_s': flight.horizons[h],
                    'heading_rad': flight.headings[s],
                    'error_m': error[:3],
                    'error_rad': error[3:],
                    'coasting_m': coasting[:3],
                    'coasting_rad': coasting[3:],
                })  # fmt: skip
        return rows


def study_forecasts(
    name: str, bags: Sequence[Path], robot: str | None = None, tell: Tell = lambda *_: None
) -> ForecastStudy:
    """
    Forecast recorded flights with a vehicle file.

    `name`: name of the vehicle, or its file. `bags`: bag folders, results folders or .mcap files.
    `robot`: robot to read, where a bag holds several. Raise `BadInput` if the flights are not
    usable, or too short for a forecast.
    """
    vehicle = load_vehicle(name)
    try:
        flights = read_bags({'train': bags}, robot, lambda bag: tell(f'reading {bag}', None))
        tell('checking data quality', None)
        usable = select_usable_flights(flights, vehicle, CALIBRATION_TIME)
    except BadInput as fault:
        # All flights have one role, whose option has another name in other studies
        raise BadInput(str(fault).replace('--train', '--commands')) from fault
    titles = tuple(title for title, _, _ in usable.flights)
    study = ForecastStudy(
        name, titles, tuple(judge_vehicle(vehicle, usable.flights, tell)), usable.warnings
    )
    if find_main_score(study.scores) is None:
        raise BadInput(
            'No usable part of the flights is long enough to forecast from its past and to judge '
            'the forecast; record some seconds more without a gap.'
        )
    return study


def judge_vehicle(
    vehicle: Vehicle, flights: Sequence[AssignedFlight], tell: Tell = lambda *_: None
) -> list[FlightForecasts]:
    """Return the forecasts of flights with a vehicle as its file has it; none if all are short."""
    tell('preparing', 0.1)
    prepared = prepare_calibration(vehicle, [(title, 'train', one) for title, _, one in flights])
    horizons = prepared.horizons
    if not horizons:
        return []
    tell('learning the noise', 0.2)
    noise = learn_noise_of_flights(prepared, horizons)
    tell('forecasting', 0.8)
    own = list_flight_parameters(prepared.nominal, prepared.parameters)
    return forecast_flights(
        vehicle, prepared.nominal, prepared.flights['train'], own, noise, horizons
    )


def learn_noise_of_flights(
    prepared: PreparedCalibration, horizons: Sequence[float]
) -> list[NoiseModel]:
    """
    Return the noise of each flight for forecasts, the learned numbers averaged over all.

    It is that of these flights themselves: two numbers more than the readings tell.
    """
    nominal, parameters = prepared.nominal, prepared.parameters
    none = np.zeros(len(parameters))
    linear, prior = linearize_all(prepared.systems, nominal, none), ParameterPrior.of(parameters)
    guess = [NoiseModel.guess(nominal, one.flight) for one in prepared.systems]
    noise = learn_noise(linear, prior, none, guess)
    noise = fit_forecast_noise(linear, noise, prior, horizons)
    # Flights may have different sensors, of which each keeps its own noise
    mean = average_noise(noise)
    return [one.learn_from(mean) for one in noise]


def build_report(study: ForecastStudy) -> Report:
    """Return the report of a study."""
    scores = study.scores
    main = find_main_score(scores)
    assert main is not None
    pair = main.positions[FILE_MODEL], main.positions[COASTING]
    return Report(
        command='simulate --forecasts',
        subject=study.vehicle,
        headline=(
            f'{main.horizon:g} s ahead, the vehicle file forecasts the position to '
            f'{format_error(pair[0])}, and coasting to {format_error(pair[1])} (RMS of '
            f'{main.forecasts} forecasts).'
        ),
        introduction=(
            'Forecasts flights with a vehicle file, from past readings and the recorded commands. '
            'Coasting keeps body velocity and rates.'
        ),
        tiles=list(build_error_tiles(main)),
        blocks=(
            *build_error_tables({'': scores}),
            _build_picture(study, main),
            *(
                [TextSection('Warnings', study.warnings, bullets=True, printed=True)]
                if study.warnings
                else []
            ),
        ),
        data=to_json_value({
            'vehicle': study.vehicle,
            'flights': study.names,
            'summary': [_encode_score(one) for one in scores],
            'rows': study.list_rows(),
            'warnings': study.warnings,
        }),
        facts={'flights': ', '.join(study.names)},
        json_name='forecasts.json',
    )  # fmt: skip


def _encode_score(one: HorizonErrors) -> dict[str, Any]:
    """Return the RMS errors at a horizon as JSON data, in SI units."""
    return {
        'horizon_s': one.horizon,
        'count': one.forecasts,
        'vehicle': one.errors[FILE_MODEL]._asdict(),
        'coasting': one.errors[COASTING]._asdict(),
        'perfect': one.least._asdict(),
    }


def _build_picture(study: ForecastStudy, main: HorizonErrors) -> Picture:
    """Return the position error of each forecast by its start."""
    figure, flights = add_legend(create_figure()), study.forecasts
    h = flights[0].horizons.index(main.horizon)
    for kind, field in ((FILE_MODEL, 'errors'), (COASTING, 'coasting')):
        errors = np.concatenate([getattr(one, field)[:, h, :3] for one in flights])
        figure.add_scatter(
            x=np.concatenate([one.starts for one in flights]),
            y=100.0 * np.linalg.norm(errors, axis=1),
            text=np.repeat(study.names, [len(one.starts) for one in flights]),
            name=kind, mode='markers', marker={'color': COLOURS[kind]},
        )  # fmt: skip
    figure.update_xaxes(title='start of the forecast [s]')
    figure.update_yaxes(title='position error [cm]', type='log')
    caption = f'Each forecast {main.horizon:g} s ahead; point at one for the name of its flight.'
    return Picture('forecasts', 'Errors by start', caption, figure)
