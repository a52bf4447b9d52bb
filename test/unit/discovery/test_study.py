# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A study names what is missing and says what it is worth; its conclusion follows from both."""

from collections.abc import Sequence
from dataclasses import replace
import math
from pathlib import Path

from lta_config.files import find_file
from lta_discovery.calibration.calibrated_file import CALIBRATED_FILE
from lta_discovery.calibration.first_step import FirstStep
from lta_discovery.calibration.result import (
    CalibratedValue,
    Calibration,
    Correction,
    JudgedCorrection,
)
from lta_discovery.discovery.conclusion import draw_conclusion
from lta_discovery.discovery.figures import draw_picture
from lta_discovery.discovery.forecast_comparison import ForecastComparison
from lta_discovery.discovery.report import build_report
from lta_discovery.discovery.run import format_learned_vehicle
from lta_discovery.discovery.study import (
    CLOSEST,
    Discovery,
    estimate_numbers,
    NAMED,
    NamedElement,
    study_flights,
    TUNED,
    WRITTEN,
)
from lta_discovery.flights.measured_flight import MeasuredFlight, resample_flight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.posterior.missing_elements import FoundModel, MissingElements, PresentElement
from lta_discovery.state_filter.forecast_scores import ErrorRatio, FILE_MODEL
from lta_discovery.state_filter.forecasts import FlightForecasts
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel, wrench_floor
from lta_model.vehicle import load_vehicle
from lta_report.report_page import render_report
import numpy as np
import pytest

from .hidden_cases import CASES
from .hidden_flight import flown

Known = tuple[NominalVehicle, list[FreeParameter]]
DRAG = 'linear_drag.surge'
MODELS = (FILE_MODEL, TUNED, NAMED, WRITTEN)
GOOD = (0.3, 0.2, 0.05, 0.1)  # m; errors of these models along x
COAST = 0.5  # m


def forecast(flight: MeasuredFlight, error: float, coast: float = COAST) -> FlightForecasts:
    """Return forecasts every 1.5 s whose position is off by an error along x at each horizon."""
    starts = np.arange(flight.time[0] + 1.0, flight.time[-1] - 4.0, 1.5)
    errors = np.zeros((len(starts), 2, 6))
    coasting = errors.copy()
    errors[..., 0], coasting[..., 0] = error, coast
    headings = np.zeros(len(starts))
    return FlightForecasts(starts, (1.0, 3.0), errors, coasting, headings, 0.1 * coasting)


def make_study(
    known: Known,
    flight: MeasuredFlight,
    present: Sequence[PresentElement] = (PresentElement((DRAG,), 'effect', 1.0, 41.0),),
    errors: Sequence[float] = GOOD,
    coast: float = COAST,
    wrench: float = 1.0,
    closest: Sequence[PresentElement] = (),
) -> Discovery:
    """Return a study put together by hand; `wrench`: unexplained one, in noise floors."""
    nominal, parameters = known
    values, covariance = np.zeros(len(parameters)), np.zeros((len(parameters),) * 2)
    k = [one.name for one in parameters].index(DRAG)
    values[k], covariance[k, k] = 0.03, 0.002**2
    guess = NoiseModel.guess(nominal, flight)
    noise = (replace(guess, wrench=wrench * wrench_floor(nominal)),)
    none = (np.zeros((len(flight.time), 6)),)
    missing = MissingElements(
        FoundModel(tuple(present), values, covariance, noise, none),
        FoundModel((), 0.0 * values, covariance, noise, none),
        FoundModel(tuple(closest), values, covariance, noise, none) if closest else None,
        {DRAG: 0.99, 'quadratic_drag.surge': 0.03}, tuple(parameters), 1.0, (), (),
    )  # fmt: skip
    estimates = tuple(estimate_numbers(nominal, parameters[k], 0.03, 0.002))
    named, near = (
        tuple(NamedElement(one, estimates if one.kind == 'effect' else (), {}) for one in each)
        for each in (present, closest)
    )
    numbers = any(one.kind == 'effect' for one in [*present, *closest])
    names = MODELS if numbers else MODELS[:2]
    if closest:
        names = (*MODELS[:2], CLOSEST, WRITTEN)
    forecasts = {
        name: [forecast(flight, error, coast)]
        for name, error in zip(names, errors[: len(names)], strict=True)
    }
    learned = parameters[k].apply_to(nominal, 0.03) if numbers else nominal
    return Discovery(
        load_vehicle('gtmab'), nominal, learned,
        {'A': ('train', flight), 'B': ('holdout', flight)}, ('A',), missing, named, near,
        ForecastComparison(('B',), forecasts), True, ('A warning.',), FirstStep(),
    )  # fmt: skip


def test_a_name_that_forecasts_need_is_advised(gtmab: Known, clean: FlightSystem) -> None:
    one = draw_conclusion(make_study(gtmab, clean.flight))
    assert one.verdict == 'named'
    assert one.headline == 'The vehicle file lacks linear drag (surge) 0.0300 N s/m.'
    assert one.details == (
        'Position error 3 s ahead on held-out flights: 30 cm with the vehicle file, 20 cm with '
        'fitted tolerances, 5 cm with what is named as well.',
    )
    assert one.writes_file
    assert one.advice.startswith('Use the corrected vehicle file')


def test_what_cannot_be_told_apart_is_in_the_headline(gtmab: Known, clean: FlightSystem) -> None:
    names = (DRAG, 'quadratic_drag.surge')
    study = make_study(gtmab, clean.flight, [PresentElement(names, 'effect', 1.0, 41.0)])
    one = draw_conclusion(study)
    assert one.headline.endswith('linear drag (surge) 0.0300 N s/m or quadratic drag (surge).')
    assert f'lta tests between {DRAG} quadratic_drag.surge with the same --vehicle' in one.advice


@pytest.mark.parametrize(
    ('present', 'errors', 'coast', 'wrench', 'verdict', 'words'),
    [
        ((), GOOD, COAST, 1.0, 'none', 'nothing that the vehicle file lacks'),
        ((), GOOD, COAST, 2.6, 'unexplained', '(RMS) acts that follows nothing that was measured'),
        (('sway by heading',), GOOD, COAST, 1.0, 'unexplained', 'describes: sway by heading.'),
        ((DRAG,), (0.3, 0.2, 0.1, 0.4), COAST, 1.0, 'named', 'lacks linear drag'),
        ((DRAG,), GOOD, 0.04, 1.0, 'not_identifiable', 'inconclusive: linear drag (surge) 0.0300'),
    ],
)
def test_the_conclusion_follows_from_names_and_forecasts(
    gtmab: Known, clean: FlightSystem, present: Sequence[str], errors: Sequence[float],
    coast: float, wrench: float, verdict: str, words: str,
) -> None:  # fmt: skip
    """Only a name whose file forecasts no worse than the old one is written."""
    elements = [
        PresentElement((name,), 'effect' if name == DRAG else 'force', 1.0, 41.0)
        for name in present
    ]
    one = draw_conclusion(make_study(gtmab, clean.flight, elements, errors, coast, wrench))
    assert one.verdict == verdict
    assert words in one.headline
    assert not one.writes_file


def calibrate_study(study: Discovery, error: float, is_start: bool = True) -> Discovery:
    """
    Return a study whose vehicle was calibrated.

    `error`: of its forecasts [m]. `is_start`: whether the search went on from the calibrated file.
    """
    file = study.nominal
    gain = CalibratedValue('wrench_gain.surge', '1', '', 1.0, 0.3, (0.28, 0.32), True, True, ())
    calibration = Calibration('gtmab', file, file, file, (gain,), {}, 'likelihood', {})
    first = FirstStep(calibration) if is_start else FirstStep(alternative=calibration)
    forecasts = {
        FILE_MODEL: study.comparison.forecasts[FILE_MODEL],
        CALIBRATED_FILE: [forecast(study.flights['B'][1], error)],
        **study.comparison.forecasts,
    }
    return replace(
        study,
        first=first,
        comparison=replace(study.comparison, forecasts=forecasts),
    )


def test_what_is_named_has_to_forecast_no_worse_than_the_calibrated_file(
    gtmab: Known, clean: FlightSystem
) -> None:
    study = make_study(gtmab, clean.flight)  # vehicle.yaml: 10 cm
    better, worse = (draw_conclusion(calibrate_study(study, error)) for error in (0.2, 0.08))
    assert better.writes_file
    assert '30 cm with the vehicle file, 20 cm with calibrated.yaml' in better.details[0]
    assert not worse.writes_file
    assert worse.writes_calibrated
    assert worse.advice.startswith('Use the calibrated vehicle file')


def test_forecasts_confirm_what_was_calibrated(gtmab: Known, clean: FlightSystem) -> None:
    """An error of 0.8 (0.7 to 0.9) with a correction is 25 % (11 to 43) larger without it."""
    study = calibrate_study(make_study(gtmab, clean.flight, ()), 0.08)
    drag = CalibratedValue(DRAG, 'N s/m', '', 0.0, 0.04, (0.03, 0.05), True, True, ())
    judged = [
        JudgedCorrection(Correction('linear_drag', (drag,), study.nominal), ErrorRatio(*ratio))
        for ratio in ((0.8, (0.7, 0.9)), (0.9, (0.7, 1.1)))
    ]
    one = draw_conclusion(replace(study, corrections=tuple(judged)))
    (said,) = (text for text in one.details if 'confirm' in text)
    assert 'confirm linear drag (surge) 0.040 N s/m: without' in said
    assert 'the position error is 25 % (11 to 43) larger 3 s ahead' in said


@pytest.mark.parametrize('is_start', [True, False])
def test_without_a_name_the_headline_is_what_was_calibrated(
    gtmab: Known, clean: FlightSystem, *, is_start: bool
) -> None:
    one = draw_conclusion(calibrate_study(make_study(gtmab, clean.flight, ()), 0.08, is_start))
    assert one.verdict == 'none'
    assert 'surge: 30 % of the commanded force arrives' in one.headline
    assert one.details[0] == 'These flights show nothing more that the vehicle file lacks.'
    assert one.advice.startswith('Use the calibrated vehicle file')


def test_a_calibration_that_forecasts_worse_than_the_file_is_not_advised(
    gtmab: Known, clean: FlightSystem
) -> None:
    study = calibrate_study(
        make_study(gtmab, clean.flight, ()), 0.4, is_start=False
    )  # file: 30 cm
    one = draw_conclusion(study)
    assert one.headline == 'These flights show nothing that the vehicle file lacks.'
    assert one.advice == 'Keep the vehicle file.'
    assert not one.writes_calibrated


def test_effects_that_come_closest_to_an_unknown_force_are_written_where_they_help(
    gtmab: Known, clean: FlightSystem
) -> None:
    force = PresentElement(('sway by heading',), 'force', 1.0, 41.0)
    drag = PresentElement((DRAG, 'quadratic_drag.surge'), 'effect', 1.0, 20.0)
    study = make_study(gtmab, clean.flight, [force], closest=[drag])
    one = draw_conclusion(study)
    assert one.verdict == 'unexplained'
    assert one.details[0] == (
        'Of the library, linear drag (surge) 0.0300 N s/m or quadratic drag (surge) comes closest.'
    )
    assert one.writes_file
    assert one.advice == 'Use the corrected vehicle file, vehicle.yaml in the results folder.'
    report = build_report(study, one, 'gtmab', (), ())
    assert isinstance(report.data, dict)
    assert report.data['effects'] == []
    (near,) = report.data['closest']
    assert (near['knobs'], near['log_evidence']) == ([DRAG], 20.0)
    assert 'What comes closest' in render_report(report)


def test_errors_and_their_ratio_are_those_of_the_forecasts(
    gtmab: Known, clean: FlightSystem
) -> None:
    """Constant errors have a ratio without scatter."""
    comparison = make_study(gtmab, clean.flight).comparison
    assert comparison.main is not None
    assert comparison.main.horizon == 3.0
    assert comparison.main.errors[NAMED].position == pytest.approx(0.05)
    ratio = comparison.compare(NAMED, TUNED)
    assert ratio.value == pytest.approx(0.25)
    few = len(np.unique(comparison.forecasts[NAMED][0].starts // 10.0)) < 4
    assert math.isnan(ratio.ci95[0]) if few else ratio.ci95 == pytest.approx((0.25, 0.25))


def test_a_flight_too_short_for_forecasts_has_names_without_errors(
    gtmab: Known, clean: FlightSystem
) -> None:
    study = make_study(gtmab, clean.flight)
    study = replace(study, comparison=ForecastComparison(('B',), {}))
    conclusion = draw_conclusion(study)
    assert (conclusion.verdict, conclusion.details) == ('named', ())
    report = build_report(study, conclusion, 'gtmab', (), ())
    assert isinstance(report.data, dict)
    assert report.data['gaps'] == []
    assert report.headline in render_report(report)
    assert draw_picture(conclusion, study.comparison) == ''


def test_the_picture_has_a_bar_for_each_model(gtmab: Known, clean: FlightSystem) -> None:
    study = make_study(gtmab, clean.flight)
    picture = draw_picture(draw_conclusion(study), study.comparison)
    for words in (*MODELS, 'coasting', '5 cm', '50 cm', 'linear drag (surge)'):
        assert f'>{words}' in picture or words in picture
    assert picture.count('<rect') == len(MODELS) + 1


def test_the_report_has_the_same_numbers_everywhere(gtmab: Known, clean: FlightSystem) -> None:
    study = make_study(gtmab, clean.flight)
    report = build_report(study, draw_conclusion(study), 'gtmab', (), ('Another warning.',))
    assert isinstance(report.data, dict)
    (one,) = report.data['effects']
    assert (one['knobs'], one['log_evidence']) == ([DRAG], 41.0)
    surge = one['parameters']['surge']
    assert surge['value'] == pytest.approx(0.03)
    assert surge['ci95'] == pytest.approx([0.03 - 1.96 * 0.002, 0.03 + 1.96 * 0.002])
    far = next(each for each in report.data['gaps'] if each['horizon_s'] == 3.0)
    assert [far[key] for key in ('before', 'tuned', 'after', 'written', 'coast')] == (
        pytest.approx([*GOOD, COAST])
    )
    page = render_report(report)
    for words in ('0.0300 N s/m', '41 nats', 'A warning.', 'Another warning.', report.headline):
        assert words in page


def test_the_learned_file_has_the_name_and_nothing_else(
    gtmab: Known, clean: FlightSystem, tmp_path: Path
) -> None:
    path = tmp_path / 'vehicle.yaml'
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    path.write_text(format_learned_vehicle(text, make_study(gtmab, clean.flight)))
    assert 'surge 0.0300 N s/m, 95 % 0.0261 to 0.0339' in path.read_text()
    read = NominalVehicle.from_vehicle(load_vehicle(str(path)))
    assert read.parameter_value('linear_drag', 'surge') == pytest.approx(0.03)
    assert read.mass == gtmab[0].mass
    assert read.parameter_value('linear_drag', 'heave') == gtmab[0].parameter_value(
        'linear_drag', 'heave'
    )


@pytest.mark.long
def test_a_hidden_drag_is_named_with_its_value_and_shrinks_the_error() -> None:
    roles = ('train', 'confirm', 'holdout')
    flights = [
        (f'flight {k}', role, resample_flight(flown(CASES[DRAG], 500 + k, 44.0)))
        for k, role in enumerate(roles)
    ]
    study = study_flights(load_vehicle('gtmab'), flights)
    assert [one.present.names for one in study.named] == [(DRAG,)]
    (value,) = study.named[0].estimates
    assert value.ci95[0] < 0.03 < value.ci95[1]
    assert study.comparison.main is not None
    errors = study.comparison.main.errors
    assert errors[NAMED].position < 0.6 * errors[TUNED].position
    assert errors[WRITTEN].position < errors[FILE_MODEL].position
