"""
Names by forecasts, where the readings gave none: real flights of a model that is far from exact.

A likelihood over every reading is right where what the model misses is small. Where it is many
times the noise, or a filter ate the noise, a few seconds of forecast are what is left to judge by;
and what is named by them has to hold in regimes that were left out of the fit, and between the
flights that teach and those that confirm, both ways. A name that does not is said to interpolate.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final, final, NamedTuple

from lta_discovery.finding import GroupShare, LeftOutRegime, TransferEvidence
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.replay.linearized_flight import LinearizationPoint, SENSORS, zero_unknowns
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_discovery.study import DiscoveryStudy, StudyComparison, StudyFlight
from lta_discovery.transfer.candidate_groups import CandidateGroup, list_groups
from lta_discovery.transfer.confirmation import confirm_groups
from lta_discovery.transfer.cross_validation import (
    RegimeError,
    remaining_error_share,
    sum_squared_error,
    TOLD,
)
from lta_discovery.transfer.forecast_gaps import compute_forecast_gaps
from lta_discovery.transfer.forward_selection import GroupSelection, select_forward
from lta_discovery.transfer.full_refit import refit_everything
from lta_discovery.transfer.group_values import fit_groups, GroupValues, tune_tolerances
from lta_discovery.transfer.named_effects import build_effects
from lta_discovery.transfer.overlapping_pieces import cut_long_pieces, piece_spacing
from lta_discovery.transfer.regimes import group_by_regime
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Progress = Callable[[str, float | None], None]

FEWEST: Final = 4  # flights that teach or confirm, where a filter ate the noise
LARGE: Final = 10.0  # floors; what remains where readings are not to be asked
ENOUGH: Final = 8  # the same, where it did not: readings have been asked already
LIFT: Final = 0.0025  # of the weight, that a flight's lift may be off by (as between RGBlimp's)
TUNED: Final = 0.97  # of the squared error that tuning tolerances leaves, in regimes left out
LOOSE: Final = 0.8  # of the squared error; what tolerances take more of, they explain
BESIDE: Final = 0.95  # the same, where tolerances are tuned beside the names
ATTEMPTS: Final = 4  # to name, each without what fell before
GRAVITY: Final = 9.81  # m/s2
POSE: Final = 6  # of CHANNELS, the first


@final
class ForecastFlights(NamedTuple):
    """Flights that can be predicted far enough, each as flown and in overlapping pieces."""

    flown: list[StudyFlight]
    sight: ForecastFitter


@final
class TransferOutcome(NamedTuple):
    """What was chosen last, what of it stands with its values, and what fell on the way."""

    chosen: GroupSelection
    kept: Sequence[CandidateGroup]
    best: GroupValues | None
    lost: Sequence[CandidateGroup]


def needs_forecasts(study: DiscoveryStudy) -> bool:
    """Tell whether forecasts are to be asked: poses alone, and something without a name."""
    finding = study.finding
    if finding.verdict not in ('unexplained', 'named+unexplained', 'not_identifiable'):
        return False
    told = [one.flight.replay.flight for one in study.flights if one.role != 'holdout']
    if any(np.isfinite(flight.noise[POSE:]).any() for flight in told):
        return False
    smooth = all(flight.alike > 1.0 for flight in told)
    if smooth:
        return len(told) >= FEWEST
    large = any(one.floors >= LARGE for one in finding.remains)
    return large and not finding.effects and len(told) >= ENOUGH


def name_by_forecasts(study: DiscoveryStudy, tell: Progress) -> DiscoveryStudy:
    """
    Return a study with the names that forecasts give; as it was where they give none.

    Parameters
    ----------
    found : Study
        By the readings.
    tell : callable
        Told what is being done.

    """
    if not needs_forecasts(study):
        return study
    tell('asking forecasts', 0.0)
    taught = _cut_forecast_flights(study, [one for one in study.flights if one.role != 'holdout'])
    if taught is None or len(taught.flown) < FEWEST:
        return study
    parts = _split_regimes(taught)
    plain, rest = tune_tolerances(taught.sight, parts)
    if remaining_error_share(rest) < LOOSE:
        return _add_warning(study, format_tolerance_share(remaining_error_share(rest)))
    names = _select_groups(taught, parts, rest, study.finding.seed, tell)
    if names.best is None:
        return _report_lost(study, names.lost)
    models = {'before': np.zeros_like(plain), 'tuned': plain, 'after': names.best.fitted.values}
    numbers = 0
    if len(taught.flown) >= ENOUGH:
        tell('refitting everything', 0.9)
        models['refitted'], numbers = refit_everything(taught.sight, names.best.fitted.values)
    told = _summarize_transfer(
        names.chosen, names.kept, names.best, [one.name for one in names.lost], numbers
    )
    return _add_gaps(_add_effects(study, taught, names, names.best, told), taught, models)


def _select_groups(
    taught: ForecastFlights,
    parts: Mapping[str, Sequence[int]],
    rest: Sequence[RegimeError],
    seed: int,
    tell: Progress,
) -> TransferOutcome:
    """Return the names that stand; one that falls makes room for others, a few times."""
    candidates, lost = list_groups(taught.sight.knobs), []
    halves = [
        [f for f, one in enumerate(taught.flown) if one.role == role]
        for role in ('train', 'confirm')
    ]
    every = range(len(taught.flown))
    for attempt in range(ATTEMPTS):
        tell('asking forecasts', attempt / ATTEMPTS)
        chosen = select_forward(taught.sight, every, parts, candidates)
        both = confirm_groups(taught.sight, chosen, halves)
        best, kept = _validate_groups(taught.sight, both, parts, seed, rest)
        fell = [one for one in chosen.groups if one not in kept]
        lost += fell
        if not fell:
            break
        candidates = [one for one in candidates if one not in fell]
    return TransferOutcome(chosen, kept, best, lost)


def _summarize_transfer(
    chosen: GroupSelection,
    confirmed: Sequence[CandidateGroup],
    best: GroupValues,
    lost: Sequence[str],
    numbers: int,
) -> TransferEvidence:
    """Return what names rest on."""
    worth = {group.name: share for group, share in zip(chosen.groups, chosen.worth, strict=True)}
    return TransferEvidence(
        tuple(GroupShare(one.name, worth[one.name]) for one in confirmed),
        tuple(LeftOutRegime(one.name, one.flights, one.ratio) for one in best.regimes),
        tuple(lost),
        numbers,
    )


def _cut_forecast_flights(
    study: DiscoveryStudy, selected: Sequence[StudyFlight]
) -> ForecastFlights | None:
    """Return some flights in pieces that are predicted; None where there are none."""
    knobs = selected[0].flight.knobs if selected else []
    apart = piece_spacing([one.flight.replay.flight for one in selected])
    cut = [(one, cut_long_pieces(one.flight, knobs, apart)) for one in selected]
    known = [(one, flight) for one, flight in cut if flight is not None]
    if not known:
        return None
    lift = LIFT * GRAVITY * study.nominal.mass
    flights: list[FlightLinearizer] = [flight for _, flight in known]
    return ForecastFlights([one for one, _ in known], ForecastFitter(study.nominal, flights, lift))


def _split_regimes(taught: ForecastFlights) -> Mapping[str, Sequence[int]]:
    """Return the regimes of flights; where all are of one, every flight by itself."""
    parts = group_by_regime(taught.sight.flights)
    if len(parts) > 1:
        return parts
    return {f'flight {one.name}': [f] for f, one in enumerate(taught.flown)}


def _validate_groups(
    sight: ForecastFitter,
    groups: Sequence[CandidateGroup],
    parts: Mapping[str, Sequence[int]],
    seed: int,
    rest: Sequence[RegimeError],
) -> tuple[GroupValues | None, Sequence[CandidateGroup]]:
    """Return the most of some names that make every regime better, and more than tuning does."""
    while groups:
        best = fit_groups(sight, groups, parts, seed)
        better = all(one.ratio < 1.0 for one in best.regimes)
        if better and sum_squared_error(best.regimes) < TUNED * sum_squared_error(rest):
            beside = tune_tolerances(sight, parts, groups)[1]
            if sum_squared_error(beside) < BESIDE * sum_squared_error(rest):
                return best, groups
        groups = groups[:-1]
    return None, groups


def _report_lost(study: DiscoveryStudy, lost: Sequence[CandidateGroup]) -> DiscoveryStudy:
    """Return a study as it was, with what forecasts did not confirm."""
    return _add_warning(study, format_interpolation([one.name for one in lost])) if lost else study


def _add_warning(study: DiscoveryStudy, sentence: str) -> DiscoveryStudy:
    """Return a study with one more warning."""
    warnings = (*study.finding.warnings, sentence)
    return replace(study, finding=replace(study.finding, warnings=warnings))


def format_tolerance_share(share: float) -> str:
    """Return in words that tolerances leave only a share of the squared error."""
    taken = f'{100.0 * (1.0 - share):.0f} %'
    return (
        f'Forecasts name nothing: tolerances of the vehicle file alone take {taken} of the '
        'squared error in regimes left out, and no name can be told from them.'
    )


def format_interpolation(names: Sequence[str]) -> str:
    """Return in words that names did not carry over."""
    more = f' and {len(names) - TOLD} more' if len(names) > TOLD else ''
    return (
        f'{", ".join(names[:TOLD])}{more}: interpolation only; it makes forecasts better where it '
        'was fitted, and not for flights or regimes that were left out.'
    )


def _add_effects(
    study: DiscoveryStudy,
    taught: ForecastFlights,
    names: TransferOutcome,
    best: GroupValues,
    carried: TransferEvidence,
) -> DiscoveryStudy:
    """Return a study with names."""
    knobs, warnings = taught.sight.knobs, study.finding.warnings
    if carried.interpolates:
        warnings = (*warnings, format_interpolation(carried.interpolates))
    finding = replace(
        study.finding,
        verdict='named+unexplained',
        effects=build_effects(study.nominal, knobs, names.chosen, names.kept, best),
        warnings=warnings,
        carried=carried,
    )
    learned = apply_parameters(study.nominal, knobs, best.fitted.values)[0]
    return replace(study, finding=finding, learned=learned)


def _add_gaps(
    study: DiscoveryStudy, taught: ForecastFlights, models: Mapping[str, Array]
) -> DiscoveryStudy:
    """Return a study with the gap, on flights that nothing was fitted to where there are any."""
    last = _cut_forecast_flights(study, [one for one in study.flights if one.role == 'holdout'])
    shown = last or taught
    told = compute_forecast_gaps(shown.sight, models, study.finding.seed)
    finding = replace(study.finding, gaps=tuple(told), held_out=last is not None)
    seen = [_compare_models(study, one, models) for one in shown.flown]
    every = models.get('refitted')
    whole = (
        None if every is None else apply_parameters(study.nominal, taught.sight.knobs, every)[0]
    )
    return replace(study, finding=finding, shown=seen, refitted=whole)


def _compare_models(
    study: DiscoveryStudy, study_flight: StudyFlight, models: Mapping[str, Array]
) -> StudyComparison:
    """Return a flight under each model."""
    flight = study_flight.flight
    none = zero_unknowns(flight.replay.cut)
    points = []
    for kind in ('before', 'tuned', 'after'):
        nominal, values = apply_parameters(study.nominal, flight.knobs, models[kind])
        points.append(LinearizationPoint(nominal, np.append(values, np.zeros(len(SENSORS))), none))
    return StudyComparison(study_flight, *points)
