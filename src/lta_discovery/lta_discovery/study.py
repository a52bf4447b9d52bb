"""Run a study of the flights of one vehicle: search, verification, forecasts, finding."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.calibration.offsets import (
    format_calibration_warning,
    list_calibration_offsets,
)
from lta_discovery.calibration.priors import apply_calibration, free_flight_lifts
from lta_discovery.calibration.result import Calibration
from lta_discovery.conclusion import FAR, find_added_gain, find_useless_forecast
from lta_discovery.finding import ChannelErrors, SearchCandidate, StudyResult, Verdict
from lta_discovery.fit.bounds import find_exceeded_tolerances, format_bounds_warning
from lta_discovery.fit.evidence import per_flight_variance, wrench_floor
from lta_discovery.fit.joint_fit import FlightFit, JointFit, JointFitter, RAN_AWAY
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.flights.outliers import remove_outliers
from lta_discovery.flights.role_assignment import assign_roles, Role, ROLES
from lta_discovery.flights.sentence_merger import merge_sentences
from lta_discovery.flights.windows import cut_into_pieces, FEWEST
from lta_discovery.forecast.file_comparison import (
    ComparedFits,
    format_share_warning,
    format_withdrawal,
    limit_to_file,
)
from lta_discovery.forecast.forecast_warnings import should_keep_file
from lta_discovery.forecast.held_out import build_model_points, compute_model_errors
from lta_discovery.forecast.tolerance_shrinkage import shrink_tolerances
from lta_discovery.model.candidates import expand_vectors
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.page.formatting import format_parameter
from lta_discovery.replay.diverging_pieces import drop_diverging_pieces
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.knot_count import count_needed_knots
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.replay.replay import FlightReplay
from lta_discovery.replay.sensing import estimate_floor_pressure, SensorPlaces
from lta_discovery.selection.detection_limit import compute_detection_limits
from lta_discovery.selection.effect_search import EffectSearch, EffectSearchResult, SelectionRound
from lta_discovery.selection.effect_sizes import apply_named_effects, build_effects
from lta_discovery.selection.effect_verification import EffectVerification, VerifiedEffects
from lta_discovery.selection.equivalence_classes import classify_data_kind, is_equivalent, Kind
from lta_discovery.selection.flight_information import attribute_information
from lta_discovery.unmodeled.unmodeled_forces import assess_unmodeled_forces, UnmodeledForces
from lta_model.vehicle import Vehicle
from lta_report.formatting import format_count

Progress = Callable[[str, float], None]

FASTER: Final = 1.25  # times as many knots; above it the search is repeated


@final
@dataclass(frozen=True, slots=True)
class StudyFlight:
    """One flight of a study."""

    name: str
    role: str
    flight: FlightLinearizer


@final
@dataclass(frozen=True, slots=True)
class ThreeModelComparison:
    """One flight under three models; a held-out flight took no part in their fit."""

    study_flight: StudyFlight
    # The vehicle file; the file with fitted tolerances and no new effect; with the named effects
    before: LinearizationPoint
    tuned: LinearizationPoint
    after: LinearizationPoint


@final
@dataclass(frozen=True, slots=True)
class DiscoveryStudy:
    """A finding, with the flights and fits that the page needs."""

    finding: StudyResult  # texts and numbers
    # The vehicle of the file, and the same with the named effects
    nominal: NominalVehicle
    learned: NominalVehicle
    flights: Sequence[StudyFlight]
    # The held-out flights, or the confirming ones where there are none
    comparisons: Sequence[ThreeModelComparison]
    # Training flights, then confirming ones, with fitted tolerances and no new effect
    bare: Sequence[FlightFit] = ()
    full: Sequence[FlightFit] = ()  # the same with the named effects
    # The vehicle with all parameters fitted to forecasts; valid only between the flown regimes
    refitted: NominalVehicle | None = None
    # Text of the calibrated vehicle file, if the vehicle was calibrated first
    calibrated_file: str = ''
    # Joint fit with the named effects, and the fit whose values forecast
    joint: JointFit | None = None
    forecasts: JointFit | None = None


def study_flights(
    vehicle: Vehicle,
    flights: Sequence[Role],
    seed: int = 0,
    progress: Progress | None = None,
    calibration: Calibration | None = None,
    has_own_lifts: bool = False,
) -> DiscoveryStudy:
    """
    Find missing effects, confirm them, and measure how much they improve predictions.

    `flights`: role 'train', 'confirm' or 'holdout'. Without a confirming flight the training
    flights are split; a single flight is split into three parts. `calibration`: of the vehicle,
    which then has the calibrated values. `has_own_lifts`: whether the net lift of a flight says
    nothing about the next. Raise `BadInput` if there is no training flight, or a flight is too
    short for a prediction.
    """
    tell = progress or (lambda what, part: None)
    tell('preparing', 0.0)
    nominal = NominalVehicle.from_vehicle(vehicle)
    prepared, parameters, warnings = _prepare_flights(
        vehicle, nominal, flights, calibration, has_own_lifts
    )
    prepared, dropped = _drop_diverging_pieces(nominal, prepared)
    warnings.extend(dropped)
    prepared, search = _search_effects(
        nominal, prepared, lambda part: tell('searching', 0.05 + 0.6 * part)
    )
    pair = _select_role(prepared, 'train'), _select_role(prepared, 'confirm')
    tell('verifying', 0.65)
    proven = EffectVerification(nominal, [*pair[0], *pair[1]]).run(search)
    tell('predicting', 0.9)
    # Without held-out flights the confirming ones have to serve, which is optimistic.
    held_out = bool(_select_role(prepared, 'holdout'))
    last = [f for f in prepared if f.role == ('holdout' if held_out else 'confirm')]
    compared = _fit_forecast_models(nominal, [*pair[0], *pair[1]], proven, seed)
    if compared.share < 1.0:
        warnings.append(format_share_warning(compared.share))
    if compared.withdrawn:
        warnings.append(format_withdrawal(proven.names))
        proven = proven.without_effects()
    models = [build_model_points(f.flight, nominal, compared.bare, compared.full) for f in last]
    differences = compute_model_errors([f.flight for f in last], models, seed)
    if not held_out:
        warnings.append(
            'No flight was held out (--holdout), so the prediction errors are those of the '
            'confirming flights, which were also used for the fit, and may be too small.'
        )
    strained = find_exceeded_tolerances(parameters, proven.full.prior, proven.full.fitted.mean)
    warnings.extend(format_bounds_warning([format_parameter(name) for name in strained]))
    offsets = list_calibration_offsets(
        nominal,
        parameters,
        proven.full,
        [one.name for role in ('train', 'confirm') for one in prepared if one.role == role],
        tuple(expand_vectors(proven.names)),
    )
    if calibration is not None:
        offsets = ()  # `find_exceeded_tolerances` reports what a calibration does not explain
    warnings.extend(format_calibration_warning(offsets))
    # Whatever the named effects leave is described, not named.
    rest = assess_unmodeled_forces(pair, proven.full, wrench_floor(nominal))
    is_worse = compared.share < 1.0 or should_keep_file(differences)
    if is_worse or find_useless_forecast(differences) is not None:
        rest = rest.without_causes()
    kind = classify_data_kind([f.flight.replay.flight for f in prepared])
    finding = StudyResult(
        verdict=decide_study_verdict(proven, rest, differences, kind),
        effects=build_effects(nominal, proven, parameters, rest.has_unmodeled_forces),
        ladder=tuple(_list_round_candidates(step) for step in (*search.steps, *proven.steps)),
        where=(),
        gaps=tuple(differences),
        held_out=held_out,
        remains=rest.remains,
        warnings=tuple(warnings),
        seed=seed,
        bags={role: tuple(f.name for f in prepared if f.role == role) for role in ROLES},
        vehicle=vehicle.file.name,
        detectable=compute_detection_limits(
            proven.full.reduce_sides(len(pair[0])),
            proven.full.prior,
            parameters,
            tuple(expand_vectors(proven.names)),
        ),
        unexplained=rest.sentences,
        draught=rest.draught,
        strained=tuple(strained),
        offsets=offsets,
        calibration=calibration,
        training=compared.errors,
        information=attribute_information(
            proven.full,
            parameters,
            [f.name for role in ('train', 'confirm') for f in prepared if f.role == role],
        ),
    )
    seen = [ThreeModelComparison(f, *each) for f, each in zip(last, models, strict=True)]
    tell('done', 1.0)
    after = apply_named_effects(nominal, proven, parameters, finding.effects)
    fits = proven.bare.members, proven.full.members
    return DiscoveryStudy(
        finding, nominal, after, prepared, seen, *fits, joint=proven.full, forecasts=compared.full
    )


def _prepare_flights(
    vehicle: Vehicle,
    nominal: NominalVehicle,
    flights: Sequence[Role],
    calibration: Calibration | None,
    has_own_lifts: bool,
) -> tuple[list[StudyFlight], list[FreeParameter], list[str]]:
    """Return the linearizers of the flights, the free parameters, and warnings about the data."""
    tidy, remarks = _remove_outliers(flights)
    assigned, warnings = assign_roles(tidy)
    # The wrench is measured only where motor telemetry or a test stand gave it.
    parameters = list_free_parameters(
        nominal, any(flight.wrench is not None for _, _, flight in assigned)
    )
    if calibration is not None:
        parameters = apply_calibration(parameters, nominal, calibration.values)
    elif has_own_lifts:
        parameters = free_flight_lifts(parameters, nominal)
    prepared = [
        StudyFlight(name, role, prepare_flight(vehicle, each, parameters))
        for name, role, each in assigned
    ]
    _check_long_enough(prepared)
    return prepared, parameters, [*warnings, *remarks]


def _drop_diverging_pieces(
    nominal: NominalVehicle, flights: Sequence[StudyFlight]
) -> tuple[list[StudyFlight], list[str]]:
    """Return the flights without the pieces that the vehicle file cannot follow, and warnings."""
    remaining, remarks = [], []
    for one in flights:
        linearizer, count = drop_diverging_pieces(one.flight, nominal)
        if count:
            remarks.append(
                f'{one.name}: {format_count(count, "piece")} of the flight left out, as the '
                'simulation with the vehicle file diverges within a second.'
            )
        if len(linearizer.replay.first):
            remaining.append(replace(one, flight=linearizer))
    for role in dict.fromkeys(one.role for one in flights):
        if not any(one.role == role for one in remaining):
            raise BadInput(RAN_AWAY)
    return remaining, merge_sentences(remarks, len(flights))


def _select_role(flights: Sequence[StudyFlight], role: str) -> list[FlightLinearizer]:
    return [one.flight for one in flights if one.role == role]


def _search_effects(
    nominal: NominalVehicle, flights: list[StudyFlight], tell: Callable[[float], None]
) -> tuple[list[StudyFlight], EffectSearchResult]:
    """
    Search for missing effects; return the flights with enough knots, and the result.

    The knot count follows from the fastest motion of the vehicle file and of the measured
    attitude. If the fit is faster than both, the search is repeated with more knots.
    """
    knots = count_needed_knots([one.flight for one in flights], nominal)
    while True:
        flights = [replace(one, flight=one.flight.with_knots(knots)) for one in flights]
        pair = _select_role(flights, 'train'), _select_role(flights, 'confirm')
        search = EffectSearch(nominal, pair).run(tell)
        fitted = [joint.group.linears[0].point.nominal for joint in search.fits]
        needed = max(
            count_needed_knots(side, each) for side, each in zip(pair, fitted, strict=True)
        )
        # Repeating the search is slow: accept slightly too few knots
        if needed <= FASTER * knots:
            return flights, search
        knots = needed


def _fit_forecast_models(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    proven: VerifiedEffects,
    seed: int,
) -> ComparedFits:
    """Return the fits without and with effects, tolerances shrunk to what forecasts support."""
    parameters = flights[0].knobs
    fitter = JointFitter(nominal, flights, per_flight_variance(parameters), wrench_floor(nominal))
    named = expand_vectors(proven.names)
    places = [k for k, knob in enumerate(parameters) if knob.name in named]
    bare = shrink_tolerances(fitter, proven.bare)
    full = shrink_tolerances(fitter, proven.measured, places) if places else bare
    return limit_to_file(nominal, flights, bare, full, places, seed)


def _remove_outliers(flights: Sequence[Role]) -> tuple[list[Role], list[str]]:
    """Remove outliers from the flights, and describe what was removed."""
    out, remarks = [], []
    for name, role, flight in flights:
        clean, count = remove_outliers(flight)
        out.append((name, role, clean))
        if count:
            remarks.append(f'{name}: outliers removed from the readings: {count}.')
    return out, merge_sentences(remarks, len(flights))


def prepare_flight(
    vehicle: Vehicle, flight: MeasuredFlight, parameters: Sequence[FreeParameter]
) -> FlightLinearizer:
    """Return a flight that is ready to be replayed and linearized."""
    replay = FlightReplay(flight, cut_into_pieces(flight), vehicle.pack_command(()))
    # The floor pressure needs the place of the barometer, and the places need the floor pressure.
    places = SensorPlaces.from_vehicle(vehicle, 0.0)
    return FlightLinearizer(
        replay,
        parameters,
        SensorPlaces.from_vehicle(vehicle, estimate_floor_pressure(flight, places)),
    )


def _check_long_enough(flights: Sequence[StudyFlight]) -> None:
    """Raise an error if the flights of a role have too few usable pieces together."""
    for role in dict.fromkeys(one.role for one in flights):
        own = [one for one in flights if one.role == role]
        pieces = sum(len(one.flight.replay.first) for one in own)
        # One piece can confirm or test what several have taught
        least = FEWEST if role == 'train' else 1
        if pieces < least:
            raise BadInput(
                f'{", ".join(one.name for one in own)}: too little usable data for the role '
                f"'{role}' (pieces without a gap: {pieces}, needed: {least}). "
                'Record more or longer flights, with fewer gaps.'
            )


def _list_round_candidates(step: SelectionRound) -> tuple[SearchCandidate, ...]:
    return tuple(
        SearchCandidate(
            trial.name, trial.gain, trial.replicated, trial.held_out, trial.apart,
            trial.name == step.named,
        )
        for trial in step.trials
    )  # fmt: skip


def decide_study_verdict(
    proven: VerifiedEffects,
    rest: UnmodeledForces,
    differences: Sequence[ChannelErrors],
    kind: Kind,
) -> Verdict:
    """
    Decide the verdict of a study.

    A rival that flights of this kind can never distinguish does not put a name in question.
    """
    # A model that ignores the commands must not predict the position better than the fitted ones.
    far = [gap for gap in differences if gap.channel == 'position' and gap.horizon_s == FAR]
    if far and far[0].coast < min(far[0].tuned, far[0].after):
        effects = [name.partition('.')[0] for name in proven.names]
        idle = bool(effects) and find_added_gain(differences, effects) is None
        if idle or not rest.is_trackable:
            return 'not_identifiable'
    doubted = [
        any(not is_equivalent(name, one, kind) for one in proven.unlike[name])
        for name in proven.names
    ]
    if doubted and all(doubted):
        return 'not_identifiable'
    return rest.decide_verdict(proven.names)
