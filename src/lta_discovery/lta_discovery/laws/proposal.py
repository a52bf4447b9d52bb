"""
Propose a law where a study ends with a force that no effect of the library explains.

The terms are selected on training and confirming flights. The law is proposed only if it makes the
forecasts of held-out flights better; nothing that was named or fitted before changes.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Final

from lta_config.schema.vehicle_law import coefficient_unit, HiddenState, Law, LawTerm
from lta_discovery.conclusion import FAR, find_law_obstacle
from lta_discovery.finding import ChannelErrors, LawFinding, StudyResult
from lta_discovery.fit.evidence import wrench_floor
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.forecast.held_out import (
    compute_forecast_residuals,
    summarize_residuals,
    WHOLE,
)
from lta_discovery.laws.dictionary import build_dictionary, Column, round_number
from lta_discovery.laws.forecast import FlightLaw, LawForecaster, Prepare
from lta_discovery.laws.law_data import FlightQuantities, LawData
from lta_discovery.laws.regression import LAW_AXES
from lta_discovery.laws.selection import LawFit, select_terms
from lta_discovery.page.formatting import explain_decision, format_parameter
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.selection.interval import NORMAL
from lta_discovery.study import DiscoveryStudy
from lta_model.law_arrays import OWN
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHARES: Final = (1.0, 0.5, 0.0)  # of the tolerances fitted with the law
KEPT: Final = 0.98  # of the score; other tolerances have to be better than this
# Of the error without the law: position or attitude has to fall below it
BETTER: Final = 0.95
WORSE: Final = 1.0  # of the error without the law; neither position nor attitude may exceed it
NEAR: Final = 3  # library effects that are listed as the nearest


def add_law(study: DiscoveryStudy, tell: Callable[[str, float], None]) -> DiscoveryStudy:
    """Return a study with the law of its unexplained force, or the reason why there is none."""
    finding = study.finding
    if 'unexplained' not in finding.verdict:
        return study
    reason = _find_obstacle(study)
    if reason or study.joint is None or study.forecasts is None:
        return replace(study, finding=replace(finding, law=LawFinding(None, reason)))
    tell('seeking a law', 0.0)
    found = _search_law(study, study.joint, study.forecasts)
    return replace(study, finding=replace(finding, law=found))


def _find_obstacle(study: DiscoveryStudy) -> str:
    """Return why no law is sought; '' if one is."""
    finding = study.finding
    if finding.carried is not None:
        return 'the effects were identified by forecasts alone'
    if not finding.held_out:
        return 'a law has to be tested on a held-out flight (--holdout)'
    if 'law' in study.nominal.given:
        return 'the vehicle file has a law already; remove it, or replace it with an effect'
    if study.joint is None:
        return 'the flights were not fitted together'
    return find_law_obstacle(finding)


def list_taught_flights(study: DiscoveryStudy) -> list[FlightLinearizer]:
    """Return the training flights, then the confirming ones."""
    return [
        one.flight for role in ('train', 'confirm') for one in study.flights if one.role == role
    ]


def collect_law_data(study: DiscoveryStudy, joint: JointFit) -> LawData:
    """Return the jointly fitted flights of a study as data for laws."""
    both = zip(list_taught_flights(study), joint.group.linears, strict=True)
    flights = map_parallel(lambda each: FlightQuantities.from_fit(*each), list(both))
    count = sum(one.role == 'train' for one in study.flights)
    return LawData(joint, flights, wrench_floor(study.nominal), count)


def _search_law(study: DiscoveryStudy, joint: JointFit, forecasts: JointFit) -> LawFinding:
    """Search, refit and test a law."""
    taught, data = list_taught_flights(study), collect_law_data(study, joint)
    chosen, given = select_terms(data, build_dictionary(data.spreads), joint.deviations)
    near = _list_near_effects(study.finding)
    if not chosen:
        return LawFinding(None, 'no term has enough evidence on training and confirming flights',
                          near=near)  # fmt: skip
    fit = LawFit(data, 'all', given.sides[0].deviations, _list_terms(data, chosen))
    law = build_law(data, chosen, fit, _format_source(study.finding))
    at = choose_parameters(study, taught, forecasts, fit.shared, partial(FlightLaw, law))
    errors = compare_forecasts(study, forecasts, partial(FlightLaw, law), at)
    written = compare_vehicle_files(study, forecasts, partial(FlightLaw, law))
    reason = judge_forecasts(errors) or judge_vehicle_file(written)
    return LawFinding(None if reason else law, reason, errors, near, law)


def _list_terms(data: LawData, chosen: Sequence[tuple[Column, int]]) -> list[tuple[Array, int]]:
    """Return the values of columns at the knots, with their axes."""
    return [(data.knots(column), axis) for column, axis in chosen]


def build_law(
    data: LawData, chosen: Sequence[tuple[Column, int]], fit: LawFit, source: str
) -> Law:
    """Return the selected columns with the weights of a fit to all flights as a law."""
    hidden = next((column.hidden for column, _ in chosen if column.hidden is not None), None)
    terms, every = [], _list_terms(data, chosen)
    for k, (column, axis) in enumerate(chosen):
        name, factors = LAW_AXES[axis], list(column.factors)
        others = [*every[:k], *every[k + 1 :]]
        # Without the term, the wrench that it explains may count as random
        rest = max(
            LawFit(data, 'all', deviations, others).evidence
            for deviations in (fit.deviations, data.joint.deviations)
        )
        value, half = float(fit.weights[k]), NORMAL * float(fit.deviation[k])
        terms.append(
            LawTerm(
                axis=name,
                coefficient=round_number(value),
                unit=coefficient_unit(name, factors, hidden),
                factors=factors,
                interval=[round_number(value - half), round_number(value + half)],
                evidence=round_number(fit.evidence - rest),
            )
        )
    return Law(source=source, terms=terms, hidden=hidden, region=_find_region(data, terms, hidden))


def _find_region(
    data: LawData, terms: Sequence[LawTerm], hidden: HiddenState | None
) -> dict[str, list[float]]:
    """Return the range of each quantity of a law in the flights that it was fitted to."""
    used = {factor.quantity for term in terms for factor in term.factors}
    state = data.quantities(hidden)
    if hidden is not None:
        used |= {factor.quantity for factor in hidden.drive}
    ends = {name: (float(np.min(state[name])), float(np.max(state[name]))) for name in used}
    # A hidden state begins at 0
    ends |= {name: (min(ends[name][0], 0.0), max(ends[name][1], 0.0)) for name in used & {*OWN}}
    return {name: [low, max(high, low + 1e-9)] for name, (low, high) in sorted(ends.items())}


def choose_parameters(
    study: DiscoveryStudy,
    taught: Sequence[FlightLinearizer],
    forecasts: JointFit,
    shared: Array,
    prepare: Prepare,
) -> Array:
    """
    Return the shared parameters with which a law forecasts its own flights best.

    Those without the law, or part of those fitted together with it.
    """
    makers = [LawForecaster(each, study.nominal, forecasts.deviations) for each in taught]
    best, least = forecasts.fitted.mean, np.inf
    for at in (forecasts.fitted.mean, *(share * shared for share in SHARES)):
        parts = [one.compute_residuals(prepare, at) for one in makers]
        score = _score_residuals(taught, np.concatenate(parts))
        if score < (KEPT if np.isfinite(least) else 1.0) * least:
            best, least = at, score
    return best


def _score_residuals(flights: Sequence[FlightLinearizer], left: Array) -> float:
    """Return the geometric mean of position and attitude errors after some seconds."""
    errors = summarize_residuals(
        flights, dict.fromkeys(('before', 'tuned', 'after', 'coast'), left), 0, tuple(WHOLE)
    )
    return float(np.exp(np.mean([np.log(one.after) for one in errors if one.horizon_s == FAR])))


def compare_forecasts(
    study: DiscoveryStudy, forecasts: JointFit, prepare: Prepare, at: Array
) -> tuple[ChannelErrors, ...]:
    """
    Return the errors on held-out flights: `after` with the law, `tuned` without it.

    `before` are those of the vehicle file.
    """
    shown = study.shown
    makers = [
        LawForecaster(each.flown.flight, study.nominal, forecasts.deviations) for each in shown
    ]
    offs = {
        'before': [compute_forecast_residuals(e.flown.flight, e.before) for e in shown],
        'tuned': [compute_forecast_residuals(e.flown.flight, e.after) for e in shown],
        'after': [one.compute_residuals(prepare, at) for one in makers],
        'coast': [compute_forecast_residuals(e.flown.flight, e.before, True) for e in shown],
    }
    return _summarize_held_out(study, offs)


def _summarize_held_out(
    study: DiscoveryStudy, offs: Mapping[str, Sequence[Array]]
) -> tuple[ChannelErrors, ...]:
    """Return the errors of each model from its residuals, an array for each held-out flight."""
    flights = [each.flown.flight for each in study.shown]
    together = {kind: np.concatenate(parts) for kind, parts in offs.items()}
    return tuple(summarize_residuals(flights, together, study.finding.seed, tuple(WHOLE)))


def compare_vehicle_files(
    study: DiscoveryStudy, forecasts: JointFit, prepare: Prepare
) -> tuple[ChannelErrors, ...]:
    """
    Return the errors of vehicle.yaml on held-out flights: `after` with the law, `tuned` without.

    It holds the named effects, but no tolerances. `before` are those of the vehicle file.
    """
    shown, at = study.shown, np.zeros_like(forecasts.fitted.mean)
    makers = [
        LawForecaster(each.flown.flight, study.learned, forecasts.deviations) for each in shown
    ]
    before = [compute_forecast_residuals(e.flown.flight, e.before) for e in shown]
    offs = {
        'before': before,
        'tuned': [one.compute_residuals(None, at) for one in makers],
        'after': [one.compute_residuals(prepare, at) for one in makers],
        'coast': before,  # not judged here
    }
    return _summarize_held_out(study, offs)


def judge_vehicle_file(errors: Sequence[ChannelErrors]) -> str:
    """Return why a law is not proposed: vehicle.yaml forecasts worse with it; '' if not."""
    worse = [
        one.channel
        for one in errors
        if one.horizon_s == FAR and not one.after <= min(one.before, one.tuned)
    ]
    return (
        f'with the law found in the vehicle file, whose tolerances are not fitted, the '
        f'{" and ".join(worse)} of held-out flights is predicted worse'
        if worse
        else ''
    )


def judge_forecasts(errors: Sequence[ChannelErrors]) -> str:
    """Return why a law is not proposed: it does not improve forecasts; '' if it does."""
    far = [one for one in errors if one.horizon_s == FAR]
    ratios = {one.channel: one.after / min(one.before, one.tuned) for one in far}
    worse = [channel for channel, ratio in ratios.items() if not ratio <= WORSE]
    if worse:
        return (
            f'with the law found, the {" and ".join(worse)} of held-out flights is predicted worse'
        )
    place = next((one for one in far if one.channel == 'position'), None)
    if place is not None and not place.after < place.coast:
        return 'with the law found, coasting still predicts held-out flights as well or better'
    if not ratios or min(ratios.values()) > BETTER:
        return 'the law found does not predict held-out flights better'
    return ''


def _list_near_effects(finding: StudyResult) -> tuple[str, ...]:
    """Return the library effects that came nearest, with the reason for their rejection."""
    named = {name for one in finding.effects for name in one.knobs}
    tried = [rung for step in finding.ladder for rung in step if rung.knob not in named]
    best = {rung.knob: rung for rung in sorted(tried, key=lambda rung: rung.total)}
    ranked = sorted(best.values(), key=lambda rung: -rung.total)[:NEAR]
    return tuple(
        f'{format_parameter(rung.knob)} ({rung.total:.0f} nats: '
        f'{explain_decision(rung, beaten=False, stands=False)})'
        for rung in ranked
    )


def _format_source(finding: StudyResult) -> str:
    """Return the source of a law: flights and program."""
    flights = [*finding.bags.get('train', ()), *finding.bags.get('confirm', ())]
    return f'lta discover from {", ".join(flights)}'
