"""When forecasts are asked for names, and that tolerances alone give none."""

from dataclasses import replace
from types import SimpleNamespace

from lta_discovery.finding import NamedEffect, ParameterEstimate, StudyResult, Verdict
from lta_discovery.fit.evidence import wrench_floor
from lta_discovery.flights.role_assignment import restrict_to_interval
from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.page.transfer_table import render_transfer
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.results.terminal import format_forecast_evidence
from lta_discovery.study import DiscoveryStudy, StudyFlight, ThreeModelComparison
from lta_discovery.transfer import forecast_identification
from lta_discovery.transfer.candidate_groups import CandidateGroup
from lta_discovery.transfer.cross_validation import RegimeForecastErrors, remaining_error_share
from lta_discovery.transfer.effect_values import EffectValues
from lta_discovery.transfer.forecast_identification import (
    add_forecast_effects,
    format_tolerance_warning,
    format_transfer_warning,
    LOOSE,
    needs_forecasts,
    TransferOutcome,
)
from lta_discovery.transfer.forward_selection import GroupSelection
from lta_discovery.transfer.other_kind import KindJudgement
from lta_discovery.unmodeled.unexplained_force import Remainder
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
LEFT = (Remainder('heave', 0.02, 30.0, (), 0.0),)


def poses_alone(
    flight: FlightLinearizer,
    knobs: list[FreeParameter],
    alike: float,
    begin: float = 0.0,
    end: float = 1.0,
) -> FlightLinearizer:
    """Return a part of a flight of which only a tracker is left, filtered or not."""
    bare = FlightLinearizer(flight.replay.with_pieces(flight.replay.cut), knobs, flight.places)
    noise = np.where(np.arange(14) < 6, 1e-3, np.inf)
    told = restrict_to_interval(flight.replay.flight, begin, end)
    bare.replay.flight = replace(told, noise=noise, alike=alike)
    return bare


def unnamed(
    nominal: NominalVehicle, flights: list[StudyFlight], verdict: Verdict = 'unexplained'
) -> DiscoveryStudy:
    """Return a study whose readings gave no name."""
    finding = StudyResult(verdict, (), (), (), (), False, LEFT, (), 1, {}, 'gtmab')
    return DiscoveryStudy(finding, nominal, nominal, flights, [])


@pytest.mark.parametrize(
    ('verdict', 'alike', 'flights', 'asked'),
    [
        ('none', 12.5, 9, False),
        ('named', 12.5, 9, False),
        ('unexplained', 12.5, 3, False),
        ('unexplained', 12.5, 4, True),
        ('unexplained', 1.0, 4, False),
        ('unexplained', 1.0, 8, True),
        ('not_identifiable', 12.5, 4, True),
    ],
)
def test_forecasts_are_asked_where_readings_have_no_name(
    gtmab: Known, clean: FlightLinearizer, verdict, alike, flights, asked
) -> None:
    bare = poses_alone(clean, gtmab[1], alike)
    blind = [StudyFlight(f'{k}', 'train', bare) for k in range(flights)]
    assert needs_forecasts(unnamed(gtmab[0], blind, verdict)) is asked
    seeing = [StudyFlight(f'{k}', 'train', clean) for k in range(flights)]
    assert not needs_forecasts(unnamed(gtmab[0], seeing, verdict))


@pytest.mark.parametrize(('share', 'asked'), [(0.99 * LOOSE, False), (1.01 * LOOSE, True)])
def test_what_tolerances_explain_is_given_no_name(
    gtmab: Known, clean: FlightLinearizer, monkeypatch, share, asked
) -> None:
    """By what tolerances leave in regimes left out, just below the limit and just above it."""
    nominal, knobs = gtmab
    parts = [('train', 0.0, 0.5), ('confirm', 0.5, 1.0)] * 2
    flights = [
        StudyFlight(f'{k}', role, poses_alone(clean, knobs, 12.5, begin, end))
        for k, (role, begin, end) in enumerate(parts)
    ]
    looked = []

    def standing(*given: object) -> TransferOutcome:
        looked.append(given)
        return TransferOutcome(GroupSelection((), (), np.zeros(len(knobs)), (), 1.0), (), None, ())

    regimes = [
        RegimeForecastErrors('slow', 3, 2.0, 2.0 * share**0.5),
        RegimeForecastErrors('fast', 1, 1.0, share**0.5),
    ]
    monkeypatch.setattr(
        forecast_identification, 'tune_tolerances', lambda *_: (np.zeros(len(knobs)), regimes)
    )
    monkeypatch.setattr(forecast_identification, '_select_groups', standing)
    before = unnamed(nominal, flights)
    found = add_forecast_effects(before, lambda what, share: None).finding
    assert (found.verdict, found.effects, bool(looked)) == ('unexplained', (), asked)
    said = () if asked else (format_tolerance_warning(share),)
    assert found.warnings == said
    assert remaining_error_share(regimes) == pytest.approx(share)


def test_what_only_interpolates_is_said_so() -> None:
    assert format_transfer_warning(['side force']).startswith('side force: interpolation only')


def test_everything_is_refitted_where_forecasts_identify_no_effect(
    gtmab: Known, clean: FlightLinearizer, monkeypatch
) -> None:
    """The file has 10 % too little thrust, and the selection chooses no effect."""
    nominal, knobs = gtmab
    thrust = next(knob for knob in knobs if knob.name == 'thrust_scale.factor')
    wrong = thrust.apply_to(nominal, -0.1)
    parts = [(0.0, 0.5, 'train'), (0.5, 1.0, 'confirm'), (0.0, 1.0, 'holdout')]
    flights = [
        StudyFlight(f'{k}', role, poses_alone(clean, knobs, 12.5, begin, end))
        for k, (begin, end, role) in enumerate(parts)
    ]
    monkeypatch.setattr(forecast_identification, 'FEWEST', 2)
    monkeypatch.setattr(forecast_identification, 'ENOUGH', 2)
    monkeypatch.setattr(forecast_identification, 'LOOSE', 0.0)
    monkeypatch.setattr(forecast_identification, 'select_forward', select_nothing)
    found = add_forecast_effects(unnamed(wrong, flights), lambda what, share: None)
    far = [gap for gap in found.finding.gaps if gap.channel == 'position']
    assert found.finding.held_out
    assert all(gap.refitted < 0.5 * gap.before for gap in far if gap.horizon_s >= 3.0)
    evidence = found.finding.carried
    assert (found.finding.effects, evidence.names) == ((), ())
    assert evidence.numbers > 20
    assert {one.name for one in evidence.regimes} == {'flight 0', 'flight 1'}
    assert found.refitted is not None
    said = format_forecast_evidence(evidence)
    assert said.startswith('Forecasts identify no effect; with all ')
    assert 'Forecasts with everything refitted' in render_transfer(found.finding)


def test_everything_is_refitted_beside_effects_that_readings_named(
    gtmab: Known, clean: FlightLinearizer, monkeypatch
) -> None:
    """The file has 10 % too little thrust, and the readings named a drag that is not there."""
    nominal, knobs = gtmab
    thrust = next(knob for knob in knobs if knob.name == 'thrust_scale.factor')
    wrong = thrust.apply_to(nominal, -0.1)
    parts = [(0.0, 0.5, 'train'), (0.5, 1.0, 'confirm'), (0.0, 1.0, 'holdout')]
    flights = [
        StudyFlight(f'{k}', role, poses_alone(clean, knobs, 1.0, begin, end))
        for k, (begin, end, role) in enumerate(parts)
    ]
    monkeypatch.setattr(forecast_identification, 'ENOUGH', 2)
    point = unchanged_vehicle_point(wrong, knobs, flights[2].flight.replay.cut)
    drag = ParameterEstimate('surge', 'N s/m', 0.0, 0.001, (0.0005, 0.0015))
    effects = (NamedEffect('linear_drag', ('linear_drag.surge',), (drag,), 50.0),)
    finding = StudyResult('named', effects, (), (), (), True, (), (), 1, {}, 'gtmab')
    before = DiscoveryStudy(
        finding, wrong, wrong, flights, [ThreeModelComparison(flights[2], point, point, point)],
        forecasts=SimpleNamespace(deviations=wrench_floor(wrong)),
    )  # fmt: skip
    found = add_forecast_effects(before, lambda what, share: None)
    far = [gap for gap in found.finding.gaps if gap.channel == 'position' and gap.horizon_s >= 3.0]
    assert far
    assert all(gap.refitted < 0.5 * gap.before for gap in far)
    assert all(gap.before == gap.after for gap in far)
    assert (found.finding.effects, found.finding.verdict) == (effects, 'named')
    assert found.refitted is not None
    said = format_forecast_evidence(found.finding.carried, named=True)
    assert said.startswith('With all ')
    assert 'Forecasts identify no effect' not in render_transfer(found.finding)
    # Where the file explains the flights, nothing is refitted
    calm = replace(before, finding=replace(finding, verdict='none', effects=()))
    assert add_forecast_effects(calm, lambda what, share: None) is calm


def select_nothing(sight: ForecastFitter, *_: object) -> GroupSelection:
    return GroupSelection((), (), np.zeros(len(sight.knobs)), (), 1.0)


def test_an_effect_that_fell_in_the_company_of_a_wrong_one_is_chosen_again(monkeypatch) -> None:
    """If no effect of a selection carries over, only the first one is left out of the next."""
    wrong, right, weak = (CandidateGroup(name, (k,)) for k, name in enumerate('abc'))
    lists = iter([(wrong, right, weak), (right, weak), (right,)])
    offered: list[list[CandidateGroup]] = []

    def select(_: object, __: object, ___: object, candidates: list[CandidateGroup]) -> object:
        offered.append(list(candidates))
        return GroupSelection(next(lists), (), np.zeros(3), (), 1.0)

    def validate(_: object, groups: list[CandidateGroup], *__: object) -> object:
        kept = [one for one in groups if one is right] if wrong not in groups else []
        values = EffectValues([], SimpleNamespace(values=np.zeros(3)), np.zeros(0), [])
        return (values if kept else None), kept

    def judge(_: object, kept: list[CandidateGroup], *__: object) -> KindJudgement:
        return KindJudgement(kept, (), ())

    for name, stub in (
        ('select_forward', select), ('_validate_groups', validate), ('judge_by_kind', judge),
        ('confirm_groups', lambda _, chosen, __: chosen.groups),
        ('split_by_kind', lambda *_: []),
        ('_list_candidates', lambda _: [wrong, right, weak]),
    ):  # fmt: skip
        monkeypatch.setattr(forecast_identification, name, stub)
    taught = SimpleNamespace(
        sight=SimpleNamespace(nominal=None, flights=(), lift=0.0),
        study_flights=[],
    )
    found = forecast_identification._select_groups(taught, {}, [], 1, lambda *_: None)
    assert offered == [[wrong, right, weak], [right, weak], [right]]
    assert (found.accepted, found.lost) == ([right], [wrong, weak])
