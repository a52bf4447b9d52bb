# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Study the flights of one vehicle: what its file lacks, with values, and what that is worth.

The search (`posterior.missing_elements`) learns from the training and confirming flights together.
The forecasts that judge its result are those of flights that it has not seen, where there are any.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_discovery.calibration.calibrated_file import CALIBRATED_FILE
from lta_discovery.calibration.corrections import judge_corrections
from lta_discovery.calibration.first_step import apply_calibration, FirstStep, free_flight_lifts
from lta_discovery.calibration.result import JudgedCorrection, WIDE
from lta_discovery.discovery.forecast_comparison import (
    compare_forecasts,
    ComparedModel,
    ForecastComparison,
)
from lta_discovery.flights.bags import assign_roles, AssignedFlight
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.flights.outliers import remove_outliers
from lta_discovery.flights.sentence_merger import merge_sentences
from lta_discovery.model.candidates import vector_components
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import apply_parameters, FreeParameter, list_free_parameters
from lta_discovery.posterior.missing_elements import (
    FoundModel,
    MissingElements,
    MissingElementSearch,
    PresentElement,
)
from lta_discovery.state_filter.forecast_noise import choose_horizons
from lta_discovery.state_filter.forecast_scores import FILE_MODEL
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_model.effects import EFFECTS
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Progress = Callable[[str, float | None], None]

# Names of the compared models, beside CALIBRATED_FILE and the vehicle file
TUNED: Final = 'tolerances fitted'
NAMED: Final = 'with what is named'
CLOSEST: Final = 'with what comes closest'
WRITTEN: Final = 'vehicle.yaml'

NO_CALIBRATION: Final = FirstStep()


@final
class ParameterEstimate(NamedTuple):
    """Estimate of a number of the vehicle."""

    name: str  # 'linear_drag.surge'; of the vehicle itself 'vehicle.mass', a factor
    unit: str  # SI; '1' for a pure number
    before: float  # value in the file; that of no effect where the file does not have it
    value: float
    ci95: tuple[float, float]
    in_file: bool  # whether the file has the effect at all


@final
@dataclass(frozen=True, slots=True)
class NamedElement:
    """Something that the file lacks, with its values."""

    present: PresentElement
    estimates: tuple[ParameterEstimate, ...]  # of the first name; none of a force
    assumed: Mapping[str, float]  # numbers of an effect that were not fitted, in SI units

    @property
    def alternatives(self) -> tuple[str, ...]:
        """Return what the flights cannot tell from it."""
        return self.present.names[1:]


@final
@dataclass(frozen=True, slots=True)
class Discovery:
    """What the flights of a vehicle tell of its file."""

    vehicle: Vehicle
    nominal: NominalVehicle  # of the file
    learned: NominalVehicle  # with what is named and can be written, and nothing else
    flights: Mapping[str, tuple[str, MeasuredFlight]]  # role and flight by name
    learned_from: tuple[str, ...]  # names of the flights of the search, in its order
    missing: MissingElements
    named: tuple[NamedElement, ...]  # the most decisive first
    # Effects and numbers that come closest to a force of another form, if forecasts are better
    closest: tuple[NamedElement, ...]
    comparison: ForecastComparison
    held_out: bool  # whether the forecasts are of flights that nothing was fitted to
    warnings: tuple[str, ...]
    first: FirstStep  # calibration of the vehicle before the search
    corrections: tuple[JudgedCorrection, ...] = ()  # of that calibration, the most useful first


def study_flights(
    vehicle: Vehicle,
    flights: Sequence[AssignedFlight],
    tell: Progress = lambda what, part: None,
    first: FirstStep = NO_CALIBRATION,
) -> Discovery:
    """
    Find what a vehicle file lacks, and forecast flights with it.

    Parameters
    ----------
    flights : sequence of (name, role, MeasuredFlight)
        Role 'train', 'confirm' or 'holdout'. Where none confirms, training flights are split; a
        single flight is split into three parts.
    first : FirstStep
        After a calibration to go on from, the vehicle has the calibrated values, but drag and
        added mass of the file.

    Raises
    ------
    BadInput
        If there is no training flight, or the flights cannot be simulated with the file.

    """
    tell('preparing', 0.0)
    nominal = NominalVehicle.from_vehicle(vehicle)
    tidy, remarks = _remove_outliers(flights)
    assigned, warnings = assign_roles(tidy)
    used = [one for one in assigned if one[1] != 'holdout']
    parameters = _list_parameters(nominal, used, first)
    missing = MissingElementSearch(vehicle, [one for _, _, one in used], parameters).run(
        lambda part: tell('searching', 0.02 + 0.78 * part)
    )
    named, closest = (
        tuple(_describe_element(nominal, missing.parameters, model, one) for one in model.present)
        if model
        else ()
        for model in (missing.found, missing.closest)
    )
    tell('forecasting', 0.8)
    held_out = any(role == 'holdout' for _, role, _ in assigned)
    last = [one for one in assigned if one[1] == ('holdout' if held_out else 'confirm')]
    if not held_out:
        warnings.append(
            'No flight was held out (--holdout): the forecasts are of flights that the search has '
            'seen, and their errors may be too small.'
        )
    models, learned = _build_models(nominal, missing, first)
    titles = _make_unique([name for name, _, _ in assigned], [role for _, role, _ in assigned])
    by_title = dict(zip(titles, assigned, strict=True))
    judged_flights = {title: each[2] for title, each in by_title.items() if each in last}
    systems = [FlightSystem(vehicle, one, []) for one in judged_flights.values()]
    horizons = choose_horizons(systems)
    training = [one for _, _, one in used]

    def compare(models: Sequence[ComparedModel]) -> ForecastComparison:
        return compare_forecasts(vehicle, training, judged_flights, models, parameters, horizons)

    comparison = compare(models)
    if closest and not comparison.is_better(CLOSEST, TUNED):
        closest, learned = (), nominal
        comparison = comparison.without(CLOSEST, WRITTEN)
    tell('done', 1.0)
    return Discovery(
        vehicle,
        nominal,
        learned,
        {title: (role, flight) for title, (_, role, flight) in by_title.items()},
        tuple(title for title, each in by_title.items() if each in used),
        missing,
        named,
        closest,
        comparison,
        held_out,
        (*warnings, *remarks),
        first,
        _judge_calibration(first, comparison, compare),
    )


def _make_unique(names: Sequence[str], roles: Sequence[str]) -> list[str]:
    """Return names of flights; the parts of a flight that was split have their role as well."""
    return [
        name if names.count(name) == 1 else f'{name} ({role})'
        for name, role in zip(names, roles, strict=True)
    ]


def _remove_outliers(flights: Sequence[AssignedFlight]) -> tuple[list[AssignedFlight], list[str]]:
    """Remove outliers from the flights, and describe what was removed."""
    out, remarks = [], []
    for name, role, flight in flights:
        clean, count = remove_outliers(flight)
        out.append((name, role, clean))
        if count:
            remarks.append(f'{name}: outliers removed from the readings: {count}.')
    return out, merge_sentences(remarks, len(flights))


def _list_parameters(
    nominal: NominalVehicle,
    flights: Sequence[AssignedFlight],
    first: FirstStep,
) -> list[FreeParameter]:
    """Return what may differ from the file."""
    # The wrench is measured only where motor telemetry or a test stand gave it
    parameters = list_free_parameters(
        nominal, any(one.wrench is not None for _, _, one in flights)
    )
    if first.calibration is not None:
        return apply_calibration(parameters, nominal, first.calibration.values)
    return free_flight_lifts(parameters, nominal) if first.lifts else parameters


def list_named_columns(
    parameters: Sequence[FreeParameter], present: Sequence[PresentElement]
) -> list[int]:
    """Return the parameters of what is present and has a value, by index."""
    names = {
        part for one in present if one.kind != 'force' for part in vector_components(one.names[0])
    }
    return [k for k, one in enumerate(parameters) if one.name in names and not one.per_flight]


def _build_models(
    nominal: NominalVehicle, missing: MissingElements, first: FirstStep
) -> tuple[list[ComparedModel], NominalVehicle]:
    """Return the models whose forecasts are compared, and the vehicle that can be written."""
    model, parameters = missing.closest or missing.found, missing.parameters
    named = list_named_columns(parameters, model.present)
    only, all_but_named = np.zeros((2, len(parameters)))
    only[named] = model.values[named]
    for k, one in enumerate(parameters):
        # What the best model has and no name says is within no tolerance
        if k in named or one.tolerance > 0.0:
            all_but_named[k] = model.values[k]
    learned = apply_parameters(nominal, parameters, only)[0]
    bare = apply_parameters(nominal, parameters, missing.bare.values)[0]
    file = nominal if first.calibration is None else first.calibration.nominal
    models = [ComparedModel(FILE_MODEL, file, missing.bare.noise)]
    if calibration := first.compared:
        noise = tuple(calibration.noise.values())
        models.append(ComparedModel(CALIBRATED_FILE, calibration.calibrated, noise))
    models.append(ComparedModel(TUNED, bare, missing.bare.noise))
    if named:
        whole = apply_parameters(nominal, parameters, all_but_named)[0]
        models.append(ComparedModel(CLOSEST if missing.closest else NAMED, whole, model.noise))
        models.append(ComparedModel(WRITTEN, learned, model.noise))
    return models, learned


def _judge_calibration(
    first: FirstStep,
    comparison: ForecastComparison,
    compare: Callable[[Sequence[ComparedModel]], ForecastComparison],
) -> tuple[JudgedCorrection, ...]:
    """
    Return what each correction of the calibration is worth.

    `comparison`: has the forecasts of the calibrated vehicle. `compare`: forecasts other models.
    """
    calibration = first.compared
    if calibration is None or comparison.main is None:
        return ()
    noise = tuple(calibration.noise.values())
    return judge_corrections(
        calibration.corrections,
        comparison.forecasts[CALIBRATED_FILE],
        lambda others: compare([ComparedModel(*each, noise) for each in others.items()]).forecasts,
    )


def _describe_element(
    nominal: NominalVehicle,
    parameters: Sequence[FreeParameter],
    model: FoundModel,
    one: PresentElement,
) -> NamedElement:
    """Return an element of a fitted model with its values in units of the file."""
    if one.kind == 'force':
        return NamedElement(one, (), {})
    parts = vector_components(one.names[0])
    estimates, assumed = list[ParameterEstimate](), dict[str, float]()
    for k, parameter in enumerate(parameters):
        if parameter.name not in parts or parameter.per_flight:
            continue
        deviation = math.sqrt(max(float(model.covariance[k, k]), 0.0))
        estimates += estimate_numbers(nominal, parameter, float(model.values[k]), deviation)
        if parameter.name.partition('.')[0] not in nominal.effect_parameters:
            assumed |= {
                f'{effect}.{name}': value
                for (effect, name), value in parameter.companions.items()
                if (effect, name) not in parameter.moves and value != 0.0
            }
    return NamedElement(one, tuple(estimates), assumed)


def estimate_numbers(
    nominal: NominalVehicle, parameter: FreeParameter, change: float, deviation: float
) -> list[ParameterEstimate]:
    """
    Return the numbers of its own effect that a parameter moves.

    `change`, `deviation`: of the parameter, relative to the file.
    """
    own, begun, out = parameter.name.partition('.')[0], parameter.enable_effect(nominal), []
    for (effect, name), rate in parameter.moves.items():
        ends = (change - WIDE * deviation, change + WIDE * deviation)
        if effect == 'vehicle':
            # Logarithms of a factor
            value, *interval = (math.exp(rate * each) for each in (change, *ends))
            low, high = sorted(interval)
            out.append(
                ParameterEstimate(f'{effect}.{name}', '1', 1.0, value, (low, high), in_file=True)
            )
        elif effect == own:
            before = begun.parameter_value(effect, name)
            low, high = sorted(before + rate * end for end in ends)
            in_file = effect in nominal.effect_parameters
            unit = next(each.unit for each in EFFECTS[effect].parameters if each.name == name)
            out.append(
                ParameterEstimate(
                    f'{effect}.{name}', unit, before, before + rate * change, (low, high), in_file
                )
            )
    return out
