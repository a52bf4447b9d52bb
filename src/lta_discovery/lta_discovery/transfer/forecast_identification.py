"""
Identify effects by forecasts, where the sensor readings do not: real flights, coarse models.

A likelihood over every reading is valid while the model error is small. If it is many times the
noise, or the noise was filtered out, forecasts over some seconds remain as a criterion. Effects
identified so have to hold in left-out regimes, and between training and confirming flights in both
directions; otherwise they are reported as interpolation.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final, final, NamedTuple

from lta_discovery.finding import IdentifiedGroup, LeftOutKind, LeftOutRegime, TransferEvidence
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.forecast.file_comparison import is_worse_than_file, Model
from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.forecast.held_out import (
    build_vehicle_point,
    compute_model_errors,
    FlightUnderModels,
    WHOLE,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint, SENSORS, zero_unknowns
from lta_discovery.study import DiscoveryStudy, StudyFlight, ThreeModelComparison
from lta_discovery.transfer.candidate_groups import CandidateGroup, list_candidate_groups
from lta_discovery.transfer.cross_validation import (
    RegimeForecastErrors,
    remaining_error_share,
    sum_squared_error,
    TOLD,
)
from lta_discovery.transfer.effect_confirmation import confirm_groups
from lta_discovery.transfer.effect_values import EffectValues, fit_effect_values, tune_tolerances
from lta_discovery.transfer.forecast_errors import compute_pose_errors
from lta_discovery.transfer.forward_selection import GroupSelection, select_forward
from lta_discovery.transfer.full_refit import refit_all_parameters
from lta_discovery.transfer.named_effects import build_named_effects
from lta_discovery.transfer.other_kind import judge_by_kind, RejectedEffect, split_by_kind
from lta_discovery.transfer.overlapping_pieces import cut_overlapping_pieces, piece_spacing
from lta_discovery.transfer.regimes import group_by_regime
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Progress = Callable[[str, float | None], None]

FEWEST: Final = 4  # training and confirming flights, if the poses were filtered
LARGE: Final = 10.0  # noise floors; with a larger remainder, readings do not decide
ENOUGH: Final = 8  # flights, if the poses were not filtered (the readings were evaluated before)
LIFT: Final = 0.0025  # of the weight; deviation of a flight's lift (as between RGBlimp's)
# of the squared error with tuned tolerances, in left-out regimes; effects need less
TUNED: Final = 0.97
LOOSE: Final = 0.8  # of the squared error; tolerances that leave less explain the flights
BESIDE: Final = 0.95  # as TUNED, if tolerances are tuned together with the effects
ATTEMPTS: Final = 4  # selections, each without the effects rejected before
GRAVITY: Final = 9.81  # m/s2
MODELS: Final[tuple[Model, ...]] = ('tuned', 'after')
SIDE: Final = 0.2  # least share of the pieces that slip to either side
POSE: Final = 6  # number of pose channels, the first of CHANNELS


@final
class ForecastFlights(NamedTuple):
    """Flights that are long enough for forecasts, as flown and in overlapping pieces."""

    study_flights: list[StudyFlight]
    sight: ForecastFitter


@final
class TransferOutcome(NamedTuple):
    """The last selection, its confirmed effects with values, and the rejected ones."""

    chosen: GroupSelection
    accepted: Sequence[CandidateGroup]
    best: EffectValues | None
    lost: Sequence[CandidateGroup]
    rejected: Sequence[RejectedEffect] = ()
    kinds: Sequence[LeftOutKind] = ()


def needs_forecasts(study: DiscoveryStudy) -> bool:
    """Return whether to use forecasts: flights with poses alone, and an unexplained remainder."""
    finding = study.finding
    if finding.verdict not in ('unexplained', 'named+unexplained', 'not_identifiable'):
        return False
    flights = [one.flight.replay.flight for one in study.flights if one.role != 'holdout']
    if any(np.isfinite(flight.noise[POSE:]).any() for flight in flights):
        return False
    # Filtered poses: `estimate_pose_noise` found correlated errors
    smooth = all(flight.alike > 1.0 for flight in flights)
    if smooth:
        return len(flights) >= FEWEST
    large = any(one.floors >= LARGE for one in finding.remains)
    return large and not finding.effects and len(flights) >= ENOUGH


def add_forecast_effects(study: DiscoveryStudy, tell: Progress) -> DiscoveryStudy:
    """Add the effects that forecasts identify to a study, or return it unchanged."""
    if not needs_forecasts(study):
        return _add_refit_with_readings(study, tell)
    tell('evaluating forecasts', 0.0)
    flights = _cut_forecast_flights(study, [one for one in study.flights if one.role != 'holdout'])
    if flights is None or len(flights.study_flights) < FEWEST:
        return study
    parts = _split_regimes(flights)
    plain, rest = tune_tolerances(flights.sight, parts)
    # Do not name an effect if tuned tolerances explain most of the error.
    if remaining_error_share(rest) < LOOSE:
        study = _add_warning(study, format_tolerance_warning(remaining_error_share(rest)))
        return _add_refit(study, flights, parts, plain, tell)
    names = _select_groups(flights, parts, rest, study.finding.seed, tell)
    if names.best is None:
        study = _warn_of_rejected_effects(study, names.lost, names.rejected)
        return _add_refit(study, flights, parts, plain, tell)
    models = {'before': np.zeros_like(plain), 'tuned': plain, 'after': names.best.fitted.values}
    numbers = 0
    if len(flights.study_flights) >= ENOUGH:
        tell('refitting everything', 0.9)
        refit = refit_all_parameters(
            flights.sight, _list_candidates(flights), names.best.fitted.values
        )
        models['refitted'], numbers = refit.values, refit.numbers
    evidence = _collect_transfer_evidence(
        names.chosen, names.accepted, names.best, [one.name for one in names.lost], numbers
    )
    evidence = replace(
        evidence,
        rejected=tuple(one.sentence for one in names.rejected),
        kinds=tuple(names.kinds),
    )
    result = _add_prediction_errors(
        _add_named_effects(study, flights, names, names.best, evidence), flights, models
    )
    if any(is_worse_than_file(result.finding.training, kind) for kind in MODELS):
        return _add_warning(
            study,
            f'{", ".join(one.name for one in names.accepted)}: not reported, because with it the '
            'flights of the fit are predicted worse than with the vehicle file.',
        )
    return result


def _select_groups(
    taught: ForecastFlights,
    parts: Mapping[str, Sequence[int]],
    rest: Sequence[RegimeForecastErrors],
    seed: int,
    tell: Progress,
) -> TransferOutcome:
    """Select effects and validate them; repeat without the rejected ones."""
    candidates, lost = _list_candidates(taught), list[CandidateGroup]()
    rejected: list[RejectedEffect] = []
    kinds: Sequence[LeftOutKind] = ()
    splits = split_by_kind(taught.sight.nominal, taught.sight.flights, taught.sight.lift)
    halves = [
        [f for f, one in enumerate(taught.study_flights) if one.role == role]
        for role in ('train', 'confirm')
    ]
    every = range(len(taught.study_flights))
    for attempt in range(ATTEMPTS):
        tell('evaluating forecasts', attempt / ATTEMPTS)
        chosen = select_forward(taught.sight, every, parts, candidates)
        both = confirm_groups(taught.sight, chosen, halves)
        best, confirmed = _validate_groups(taught.sight, both, parts, seed, rest)
        kinds = ()
        while best is not None:
            judgement = judge_by_kind(taught.sight, confirmed, best.fitted.values, splits)
            rejected, kinds = [*rejected, *judgement.rejected], judgement.kinds
            if not judgement.rejected:
                break
            # Judged again, so that the errors by kind are those of the effects that remain
            best, confirmed = _validate_groups(taught.sight, judgement.accepted, parts, seed, rest)
        fell = [one for one in chosen.groups if one not in confirmed]
        if both and not confirmed:
            # The others fell in the company of the first, so they have another chance without it
            fell = [one for one in fell if one not in both[1:]]
        lost += [one for one in fell if one.name not in {each.name for each in rejected}]
        if not fell:
            break
        candidates = [one for one in candidates if one not in fell]
    return TransferOutcome(chosen, confirmed, best, lost, rejected, kinds)


def _list_candidates(taught: ForecastFlights) -> list[CandidateGroup]:
    """Return the candidates; a hull is taken as mirror-symmetric unless it slips both ways."""
    slip = np.concatenate([one.replay.cut.start[:, 8] for one in taught.sight.flights])
    return list_candidate_groups(
        taught.sight.knobs, bool(min(np.mean(slip > 0), np.mean(slip < 0)) < SIDE)
    )


def _collect_transfer_evidence(
    chosen: GroupSelection,
    confirmed: Sequence[CandidateGroup],
    best: EffectValues,
    lost: Sequence[str],
    numbers: int,
) -> TransferEvidence:
    worth = {group.name: share for group, share in zip(chosen.groups, chosen.worth, strict=True)}
    return TransferEvidence(
        tuple(IdentifiedGroup(one.name, worth[one.name]) for one in confirmed),
        _list_left_out_regimes(best.regimes),
        tuple(lost),
        numbers,
    )


def _list_left_out_regimes(regimes: Sequence[RegimeForecastErrors]) -> tuple[LeftOutRegime, ...]:
    return tuple(LeftOutRegime(one.name, one.flights, one.ratio) for one in regimes)


def _add_refit(
    study: DiscoveryStudy,
    taught: ForecastFlights,
    parts: Mapping[str, Sequence[int]],
    plain: Array,
    tell: Progress,
) -> DiscoveryStudy:
    """
    Return a study with all numbers refitted, which predicts although no effect has a name.

    `plain`: values of the tolerances, fitted to forecasts.
    """
    # The readings may have named effects, whose model is another one
    if study.finding.effects or len(taught.study_flights) < ENOUGH:
        return study
    tell('refitting everything', 0.9)
    refit = refit_all_parameters(taught.sight, _list_candidates(taught), plain, parts)
    evidence = TransferEvidence((), _list_left_out_regimes(refit.regimes), numbers=refit.numbers)
    models = {
        'before': np.zeros_like(plain), 'tuned': plain, 'after': plain, 'refitted': refit.values,
    }  # fmt: skip
    result = replace(study, finding=replace(study.finding, carried=evidence))
    result = _add_prediction_errors(result, taught, models)
    return study if is_worse_than_file(result.finding.training, 'tuned') else result


def _add_refit_with_readings(study: DiscoveryStudy, tell: Progress) -> DiscoveryStudy:
    """
    Return a study whose readings decided, with all numbers refitted beside what they show.

    Nothing is refitted where the file explains the flights, nor to fewer flights than `ENOUGH`.
    The errors are those of the same pieces as with the other models.
    """
    finding, fit = study.finding, study.forecasts
    if fit is None or (finding.verdict == 'none' and not finding.offsets):
        return study
    based = replace(study, nominal=study.learned)
    flights = _cut_forecast_flights(based, [one for one in study.flights if one.role != 'holdout'])
    if flights is None or len(flights.study_flights) < ENOUGH:
        return study
    tell('refitting everything', 0.9)
    begin = np.zeros(len(flights.sight.knobs))
    parts = _split_regimes(flights)
    refit = refit_all_parameters(flights.sight, _list_candidates(flights), begin, parts)
    whole = apply_parameters(study.learned, flights.sight.knobs, refit.values)[0]
    error_flights = [one.study_flight.flight for one in study.comparisons]
    gaps = compute_model_errors(
        error_flights,
        [FlightUnderModels(one.before, one.tuned, one.after) for one in study.comparisons],
        finding.seed,
        refitted=[build_vehicle_point(each, whole, fit.deviations) for each in error_flights],
    )
    evidence = TransferEvidence((), _list_left_out_regimes(refit.regimes), numbers=refit.numbers)
    finding = replace(finding, gaps=tuple(gaps), carried=evidence)
    return replace(study, finding=finding, refitted=whole)


def _cut_forecast_flights(
    study: DiscoveryStudy, selected: Sequence[StudyFlight]
) -> ForecastFlights | None:
    """Return flights in overlapping pieces; None if all are too short."""
    knobs = selected[0].flight.knobs if selected else []
    apart = piece_spacing([one.flight.replay.flight for one in selected])
    cut = [(one, cut_overlapping_pieces(one.flight, knobs, apart)) for one in selected]
    long_enough = [(one, flight) for one, flight in cut if flight is not None]
    if not long_enough:
        return None
    # From a share of the weight to newtons
    lift = LIFT * GRAVITY * study.nominal.mass
    flights: list[FlightLinearizer] = [flight for _, flight in long_enough]
    return ForecastFlights(
        [one for one, _ in long_enough], ForecastFitter(study.nominal, flights, lift)
    )


def _split_regimes(taught: ForecastFlights) -> Mapping[str, Sequence[int]]:
    """Return the regimes of flights; if there is only one, every flight is a regime."""
    parts = group_by_regime(taught.sight.flights)
    if len(parts) > 1:
        return parts
    return {f'flight {one.name}': [f] for f, one in enumerate(taught.study_flights)}


def _validate_groups(
    sight: ForecastFitter,
    groups: Sequence[CandidateGroup],
    parts: Mapping[str, Sequence[int]],
    seed: int,
    rest: Sequence[RegimeForecastErrors],
) -> tuple[EffectValues | None, Sequence[CandidateGroup]]:
    """Return the longest list of effects that improves every regime and beats tuned tolerances."""
    while groups:
        best = fit_effect_values(sight, groups, parts, seed)
        better = all(one.ratio < 1.0 for one in best.regimes)
        if better and sum_squared_error(best.regimes) < TUNED * sum_squared_error(rest):
            beside = tune_tolerances(sight, parts, groups)[1]
            if sum_squared_error(beside) < BESIDE * sum_squared_error(rest):
                return best, groups
        # Drop the effect that was selected last, which has the smallest gain.
        groups = groups[:-1]
    return None, groups


def _warn_of_rejected_effects(
    study: DiscoveryStudy, lost: Sequence[CandidateGroup], rejected: Sequence[RejectedEffect]
) -> DiscoveryStudy:
    """Return a study with warnings about rejected effects."""
    if lost:
        study = _add_warning(study, format_transfer_warning([one.name for one in lost]))
    for one in rejected:
        study = _add_warning(study, f'{one.sentence}.')
    return study


def _add_warning(study: DiscoveryStudy, sentence: str) -> DiscoveryStudy:
    """Return a study with one more warning."""
    warnings = (*study.finding.warnings, sentence)
    return replace(study, finding=replace(study.finding, warnings=warnings))


def format_tolerance_warning(share: float) -> str:
    """Return a warning that tolerances alone remove most of the squared error."""
    taken = f'{100.0 * (1.0 - share):.0f} %'
    return (
        f'Forecasts identify no effect, because fitting the vehicle file within its tolerances '
        f'already removes {taken} of the squared error in flight regimes left out of the fit.'
    )


def format_transfer_warning(names: Sequence[str]) -> str:
    """Return a warning that effects did not transfer."""
    more = f' and {len(names) - TOLD} more' if len(names) > TOLD else ''
    return (
        f'{", ".join(names[:TOLD])}{more}: interpolation only; forecasts improve in the fitted '
        'flights, but not in flights or regimes that were left out of the fit.'
    )


def _add_named_effects(
    study: DiscoveryStudy,
    taught: ForecastFlights,
    names: TransferOutcome,
    best: EffectValues,
    carried: TransferEvidence,
) -> DiscoveryStudy:
    """Return a study with the identified effects."""
    knobs, warnings = taught.sight.knobs, study.finding.warnings
    if carried.interpolates:
        warnings = (*warnings, format_transfer_warning(carried.interpolates))
    warnings = (*warnings, *(f'{sentence}.' for sentence in carried.rejected))
    finding = replace(
        study.finding,
        verdict='named+unexplained',
        effects=build_named_effects(study.nominal, knobs, names.chosen, names.accepted, best),
        warnings=warnings,
        carried=carried,
    )
    learned = apply_parameters(study.nominal, knobs, best.fitted.values)[0]
    return replace(study, finding=finding, learned=learned)


def _add_prediction_errors(
    study: DiscoveryStudy, taught: ForecastFlights, models: Mapping[str, Array]
) -> DiscoveryStudy:
    """Return a study with prediction errors, on held-out flights if there are any."""
    last = _cut_forecast_flights(study, [one for one in study.flights if one.role == 'holdout'])
    error_flights = last or taught
    errors = compute_pose_errors(error_flights.sight, models, study.finding.seed)
    own = errors if last is None else compute_pose_errors(taught.sight, models, study.finding.seed)
    finding = replace(
        study.finding,
        gaps=tuple(errors),
        held_out=last is not None,
        training=tuple(one for one in own if one.channel in WHOLE),
    )
    seen = [_compare_models(study, one, models) for one in error_flights.study_flights]
    every = models.get('refitted')
    whole = (
        None if every is None else apply_parameters(study.nominal, taught.sight.knobs, every)[0]
    )
    return replace(study, finding=finding, comparisons=seen, refitted=whole)


def _compare_models(
    study: DiscoveryStudy, study_flight: StudyFlight, models: Mapping[str, Array]
) -> ThreeModelComparison:
    """Return a flight under each model."""
    flight = study_flight.flight
    none = zero_unknowns(flight.replay.cut)
    points = []
    for kind in ('before', 'tuned', 'after'):
        nominal, values = apply_parameters(study.nominal, flight.knobs, models[kind])
        points.append(LinearizationPoint(nominal, np.append(values, np.zeros(len(SENSORS))), none))
    return ThreeModelComparison(study_flight, *points)
