"""
Propose a law where a study ends with a force that no effect of the library explains.

The terms are selected on training and confirming flights. The law is proposed only if it makes the
forecasts of held-out flights better; nothing that was named or fitted before changes.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
import math
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_discovery.conclusion import FAR, find_law_obstacle
from lta_discovery.finding import ChannelErrors, LawFinding, StudyResult
from lta_discovery.fit.evidence import wrench_floor
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.forecast.held_out import (
    compute_forecast_residuals,
    summarize_residuals,
    WHOLE,
)
from lta_discovery.laws.dictionary import build_dictionary
from lta_discovery.laws.forecast import (
    FlightLaw,
    LawForecaster,
    overlap_windows,
    Prepare,
)
from lta_discovery.laws.forecast_refit import FittedLaw, ForecastRefit, LawModel
from lta_discovery.laws.law_data import FlightQuantities, LawData
from lta_discovery.laws.law_file import (
    add_law_block,
    BaseFile,
    find_named_parameters,
    find_unwritable_parameters,
    Flags,
    list_study_parameters,
    list_tolerance_changes,
    write_tolerance_file,
)
from lta_discovery.laws.law_model import (
    build_law,
    build_law_model,
    Chosen,
    list_own_numbers,
    list_terms,
    Numbers,
)
from lta_discovery.laws.quantities import thrust_ranges
from lta_discovery.laws.selection import LawFit, select_terms
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.page.formatting import explain_decision, format_parameter
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import zero_unknowns
from lta_discovery.study import DiscoveryStudy
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHARES: Final = (1.0, 0.5, 0.0)  # of the tolerances fitted with the law
DROPPED: Final = 1.005  # of the least score; fewer terms that are not worse than this suffice
KEPT: Final = 0.98  # of the score; other tolerances have to be better than this
# Of the error without the law: position or attitude has to fall below it
BETTER: Final = 0.95
WORSE: Final = 1.05  # of the error without the law; neither may exceed it, be it by chance
TESTS: Final = 3  # most tests on the same held-out flights
# Of an interval, so that its one end holds with 95 % in all tests together (Bonferroni)
CONFIDENCE: Final = 1.0 - 2.0 * 0.05 / TESTS
NEAR: Final = 3  # library effects that are listed as the nearest


def add_law(
    study: DiscoveryStudy, base: BaseFile, tell: Callable[[str, float], None]
) -> DiscoveryStudy:
    """Return a study with the law of its unexplained force, or the reason why there is none."""
    finding = study.finding
    if 'unexplained' not in finding.verdict:
        return study
    reason = _find_obstacle(study)
    if reason or study.joint is None or study.forecasts is None:
        return replace(study, finding=replace(finding, law=LawFinding(None, reason)))
    tell('seeking a law', 0.0)
    law = _search_law(study, base, study.joint, study.forecasts)
    return replace(study, finding=replace(finding, law=law))


def _find_obstacle(study: DiscoveryStudy) -> str:
    """Return why no law is sought; '' if one is."""
    finding = study.finding
    if finding.carried is not None and finding.carried.names:
        return 'the effects were identified by forecasts alone'
    if not finding.held_out:
        return 'a law has to be tested on a held-out flight (--holdout)'
    if 'law' in study.nominal.effect_parameters:
        return 'the vehicle file has a law already; remove it, or replace it with an effect'
    if study.joint is None:
        return 'the flights were not fitted together'
    return find_law_obstacle(finding)


def list_taught_flights(study: DiscoveryStudy) -> list[FlightLinearizer]:
    """Return the training flights, then the confirming ones."""
    return [
        one.flight for role in ('train', 'confirm') for one in study.flights if one.role == role
    ]


def collect_law_data(
    study: DiscoveryStudy, joint: JointFit, vehicle: Vehicle | None = None
) -> LawData:
    """Return jointly fitted flights as data for laws; a vehicle limits its thrusts."""
    both = zip(list_taught_flights(study), joint.group.linears, strict=True)
    flights = map_parallel(lambda each: FlightQuantities.from_fit(*each), list(both))
    count = sum(one.role == 'train' for one in study.flights)
    reach = thrust_ranges(vehicle) if vehicle else None
    return LawData(joint, flights, wrench_floor(study.nominal), count, reach)


@final
class Trial(NamedTuple):
    """The terms of a law that is tested, and their refit."""

    terms: Chosen
    fitted: FittedLaw


def _search_law(
    study: DiscoveryStudy, base: BaseFile, joint: JointFit, forecasts: JointFit
) -> LawFinding:
    """Search, refit and test a law."""
    flights, data = list_taught_flights(study), collect_law_data(study, joint, base.vehicle)
    chosen, fitted_terms = select_terms(data, build_dictionary(data.spreads), joint.deviations)
    near = _list_near_effects(study.finding)
    if not chosen:
        return LawFinding(None, 'no term has enough evidence on training and confirming flights',
                          near=near)  # fmt: skip
    fixed = find_unwritable_parameters(base, study)
    refit = build_refit(study, flights, joint, forecasts, fixed)
    deviations = fitted_terms.sides[0].deviations
    source = _format_source(study.finding)
    held = np.where(fixed, 0.0, forecasts.fitted.mean)

    def begin(terms: Chosen) -> tuple[LawModel, Array]:
        """Return the law of some terms, and the shared parameters that it begins with."""
        fit = LawFit(data, 'all', deviations, list_terms(data, terms))
        model = build_law_model(data, terms, fit)
        start = model.prepare(model.start)
        return model, choose_parameters(study, refit, forecasts, fit.shared, start, fixed)

    def list_trials() -> Iterator[Trial]:
        """Yield laws, the best first."""
        best, *fewer = rank_laws(refit, chosen, *begin(chosen))
        model, shared = begin(best)
        yield Trial(best, refit.fit(model, shared))
        # The tolerances as they were without a law, or fewer terms, may predict others better
        yield Trial(best, refit.hold_shared().fit(model, held))
        for terms in fewer:
            yield Trial(terms, refit.fit(*begin(terms)))

    def test_law(trial: Trial, again: bool) -> LawFinding:
        """Return a law if held-out flights support it, or the reason why they do not."""
        terms, (weights, at) = trial
        weights, steps = np.split(weights, [len(terms)])
        moved = Numbers(terms, list_own_numbers(terms)).move(data, steps)
        fit = LawFit(data, 'all', deviations, list_terms(data, moved))
        law = build_law(data, moved, fit, source, weights)
        try:
            file = write_tolerance_file(base, study, at)
        except BadInput as fault:
            return LawFinding(None, f'the vehicle file cannot hold it: {fault}', (), near, law)
        prepare = partial(FlightLaw, law)
        errors = compare_forecasts(study, forecasts, prepare, file.nominal, np.zeros_like(at))
        reason = judge_forecasts(errors, again)
        if reason:
            return LawFinding(None, reason, errors, near, law)
        return LawFinding(
            law, '', errors, near, law,
            add_law_block(file.text, law), list_tolerance_changes(study, at),
        )  # fmt: skip

    return take_first_supported(list_trials(), test_law)


def take_first_supported(
    trials: Iterable[Trial], test: Callable[[Trial, bool], LawFinding]
) -> LawFinding:
    """
    Return the first law that its test supports, or the finding on the first one if none is.

    At most `TESTS` are tested, and none twice. A test is told whether there was one before it.
    """
    tested: list[Array] = []
    failed: LawFinding | None = None
    for trial in trials:
        numbers = np.concatenate(trial.fitted)
        if any(np.array_equal(numbers, one) for one in tested):
            continue
        finding = test(trial, bool(tested))
        tested.append(numbers)
        if finding.law is not None:
            return finding
        failed = failed or finding
        if len(tested) == TESTS:
            break
    assert failed is not None
    return failed


def rank_laws(refit: ForecastRefit, chosen: Chosen, model: LawModel, at: Array) -> list[Chosen]:
    """
    Return the fewest terms that forecast the flights as well as any, then one less, if any.

    `model` is the law of all chosen terms, `at` the shared parameters that it begins with.
    """
    sets = refit.rank_terms(model, at, len(chosen))
    least = min(score for score, _ in sets)
    last = max(k for k, (score, _) in enumerate(sets) if score <= DROPPED * least)
    return [[chosen[k] for k in some] for _, some in sets[last : last + 2]]


def build_refit(
    study: DiscoveryStudy,
    taught: Sequence[FlightLinearizer],
    joint: JointFit,
    forecasts: JointFit,
    fixed: Flags,
) -> ForecastRefit:
    """Return what refits laws to the forecasts of the training and confirming flights."""
    named = find_named_parameters(study, len(forecasts.fitted.mean))
    knobs, held = list_study_parameters(study), np.ones(len(named), dtype=np.bool_)
    held[: len(knobs)] = [knob.tolerance == 0.0 for knob in knobs]
    makers = [LawForecaster(each, study.nominal, forecasts.deviations) for each in taught]
    count = sum(one.role == 'train' for one in study.flights)
    return ForecastRefit(makers, count, joint.prior, held | named | fixed)


def choose_parameters(
    study: DiscoveryStudy,
    refit: ForecastRefit,
    forecasts: JointFit,
    shared: Array,
    prepare: Prepare,
    fixed: Flags,
) -> Array:
    """
    Return the shared parameters with which a law forecasts its own flights best.

    Those without the law, or part of those fitted together with it. Named effects keep their
    values, and `fixed` parameters those of the vehicle file.
    """
    best, shared = (np.where(fixed, 0.0, each) for each in (forecasts.fitted.mean, shared))
    least, named = np.inf, find_named_parameters(study, len(best))
    for at in (best, *(np.where(named, best, share * shared) for share in SHARES)):
        score = refit.score(prepare, at)
        if score < (KEPT if np.isfinite(least) else 1.0) * least:
            best, least = at, score
    return best


def compare_forecasts(
    study: DiscoveryStudy,
    forecasts: JointFit,
    prepare: Prepare | None,
    nominal: NominalVehicle,
    at: Array,
) -> tuple[ChannelErrors, ...]:
    """
    Return the errors on held-out flights: `after` with the law, `tuned` without it.

    `before` are those of the vehicle file. The law acts on `nominal` with the changes `at`, or
    is that of `nominal` (None). The windows of the forecasts overlap; their intervals are by
    bootstrap over pieces, with `CONFIDENCE`.
    """
    offs: dict[str, list[Array]] = {name: [] for name in ('before', 'tuned', 'after', 'coast')}
    flights, blocks, count = [], [], 0
    for each in study.comparisons:
        flight = each.study_flight.flight
        dense = overlap_windows(flight, study.nominal)
        random = zero_unknowns(dense.replay.cut)
        before, tuned = (replace(point, random=random) for point in (each.before, each.after))
        maker = LawForecaster(flight, nominal, forecasts.deviations)
        offs['before'].append(compute_forecast_residuals(dense, before, learned=0))
        offs['tuned'].append(compute_forecast_residuals(dense, tuned, learned=0))
        offs['after'].append(maker.compute_dense_residuals(dense, prepare, at))
        offs['coast'].append(compute_forecast_residuals(dense, before, True, learned=0))
        flights.append(dense)
        blocks.append(count + dense.replay.cut.first // dense.replay.cut.length)
        count = int(blocks[-1].max(initial=count)) + 1
    together = {kind: np.concatenate(parts) for kind, parts in offs.items()}
    return tuple(
        summarize_residuals(
            flights, together, study.finding.seed, tuple(WHOLE),
            np.concatenate(blocks), CONFIDENCE,
        )
    )  # fmt: skip


def judge_forecasts(errors: Sequence[ChannelErrors], again: bool = False) -> str:
    """
    Return why a law is not proposed: it does not improve forecasts; '' if it does.

    What is worse has to be so beyond the interval of the difference. What is better, too, if other
    laws failed on the same flights before (`again`): each test is another chance to pass.
    """
    far = [one for one in errors if one.horizon_s == FAR]
    better, worse = [], []
    for one in far:
        without = min(one.before, one.tuned)
        ratio = one.after / without
        low, high = one.shrink_ci95 if one.before < one.tuned else one.added_ci95
        if not ratio <= 1.0 and not (ratio <= WORSE and high >= 0.0):
            worse.append(one.channel)
        if ratio <= BETTER and (low > 0.0 or math.isinf(without) or not again):
            better.append(one.channel)
    if worse:
        return (
            f'with the law found, the {" and ".join(worse)} of held-out flights is predicted worse'
        )
    place = next((one for one in far if one.channel == 'position'), None)
    if place is not None and not place.after < place.coast:
        return 'with the law found, coasting still predicts held-out flights as well or better'
    if not better:
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
        f'{explain_decision(rung, beaten=False)})'
        for rung in ranked
    )


def _format_source(finding: StudyResult) -> str:
    """Return the source of a law: flights and program."""
    flights = [*finding.bags.get('train', ()), *finding.bags.get('confirm', ())]
    return f'lta discover from {", ".join(flights)}'
