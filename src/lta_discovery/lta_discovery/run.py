"""Run a discovery: read the bags, study the flights, and write the results folder."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

from lta_bridge.bag.storage import StorageFault
from lta_bridge.provenance import describe_environment, read_commit
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_data.data_quality.free_swing import require_commands
from lta_discovery.calibration.calibrated_file import format_calibration_source
from lta_discovery.calibration.calibrated_file import NAME as CALIBRATED
from lta_discovery.calibration.first_step import (
    build_calibrated_start,
    calibrate_first,
    CalibratedStart,
    FirstStep,
)
from lta_discovery.calibration.verdict import format_lift_warning, list_differences
from lta_discovery.conclusion import draw_conclusion, forget_refit
from lta_discovery.discrepancies.discrepancy_search import BaselineFlight, find_discrepancies
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.usable_flights import select_usable_flights, UsableFlights
from lta_discovery.forecast.forecast_warnings import list_forecast_warnings
from lta_discovery.laws.law_file import BaseFile
from lta_discovery.laws.proposal import add_law
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.page import animation
from lta_discovery.page.flight_views import build_flight_views
from lta_discovery.page.page import build_report
from lta_discovery.page.page import NAME as PAGE
from lta_discovery.planning.next_flight import (
    add_confusable,
    format_next_step,
    NextFlightPlan,
    plan_for_study,
)
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.results.discovery_json import NAME, to_dict
from lta_discovery.results.learned_file import (
    add_validity,
    format_learned_vehicle,
    format_source,
)
from lta_discovery.results.overlay import write_overlay
from lta_discovery.study import DiscoveryStudy, study_flights
from lta_discovery.transfer.forecast_identification import add_forecast_effects
from lta_discovery.transfer.regimes import format_regime_warning
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.page_frame import write_file
from lta_report.report_page import render_report
from lta_report.results_folder import stage_results, write_json
import numpy as np

VEHICLE = 'vehicle.yaml'
REFITTED = 'refitted.yaml'
Tell = Callable[[str, float | None], None]


@final
@dataclass(frozen=True, slots=True)
class DiscoveryRequest:
    """Inputs of a discovery."""

    vehicle: str  # name or file
    bags: Mapping[Role, Sequence[Path]]  # 'train', 'confirm', 'holdout'
    seed: int = 1
    robot: str | None = None  # robot to read, where a bag holds several
    plan: bool = False  # whether to plan the next flight
    calibrate: bool = True  # whether to calibrate the vehicle first, where the flights call for it


@final
@dataclass(frozen=True, slots=True)
class DiscoveryResult:
    """Results of a discovery."""

    study: DiscoveryStudy
    data: Mapping[str, object]  # content of discovery.json
    page: Path


def discover_effects(request: DiscoveryRequest, folder: Path, tell: Tell) -> DiscoveryResult:
    """
    Study flights and write all results into a folder.

    Parameters
    ----------
    folder : Path
        Empty, or not there yet.

    Raises
    ------
    BadInput
        If the flights are not usable, or the folder cannot be written.

    """
    vehicle = load_vehicle(request.vehicle)
    flights = read_bags(request.bags, request.robot, lambda name: tell(f'reading {name}', None))
    for one in flights:
        require_commands(one.name, one.recording)
    tell('checking data quality', None)
    sound = select_usable_flights(flights, vehicle)
    study = add_confusable(study_usable_flights(request, vehicle, sound, tell))
    next_one = (
        plan_for_study(study, request.vehicle, tell)
        if request.plan
        else NextFlightPlan(format_next_step(study))
    )
    finding = replace(study.finding, next_flight=next_one.text)
    tell('writing results', None)
    # Stage into a temporary folder, so that a failure leaves no half-written results.
    try:
        with stage_results(folder, NAME) as part:
            next_one.write(part)
            return write_results(
                request, vehicle, replace(study, finding=finding), sound, folder, part
            )
    except OSError as error:
        raise BadInput(
            f"'{folder}' cannot be written ({error.strerror}); choose another folder with --out."
        ) from error
    except StorageFault as fault:
        raise BadInput(str(fault)) from None


def study_usable_flights(
    request: DiscoveryRequest, vehicle: Vehicle, sound: UsableFlights, tell: Tell
) -> DiscoveryStudy:
    """
    Study the usable flights; add discrepancies, warnings and versions to the finding.

    Raises
    ------
    BadInput
        If the flights cannot be studied with this vehicle file.

    """
    try:
        return _study_usable_flights(request, vehicle, sound, tell)
    except (np.linalg.LinAlgError, ArithmeticError) as fault:
        names = ', '.join(name for name, _, _ in sound.flights)
        raise BadInput(
            f'The equations of the fit have no solution for {names} with {request.vehicle} '
            f'({fault}); correct the values of the vehicle file that are far off, or leave out '
            'the shortest flight.'
        ) from fault


def _study_usable_flights(
    request: DiscoveryRequest, vehicle: Vehicle, sound: UsableFlights, tell: Tell
) -> DiscoveryStudy:
    """Return the study with all that `study_usable_flights` adds."""
    first = FirstStep()
    if request.calibrate:
        first = calibrate_first(vehicle, request.vehicle, sound.flights, tell)
    start, remarks = _go_on_from(first, request, vehicle)
    study = study_flights(
        start.vehicle if start else vehicle,
        sound.flights,
        request.seed,
        tell,
        start.calibration if start else None,
        bool(first.lifts),
    )
    study = add_forecast_effects(study, tell)
    only = format_regime_warning(study)
    warnings = [*list_forecast_warnings(study.finding.gaps), *([only] if only else [])]
    finding = replace(
        study.finding,
        where=find_discrepancies(_list_baseline_flights(study, sound), request.seed),
        vehicle=request.vehicle,
        warnings=(*sound.warnings, *remarks, *study.finding.warnings, *warnings),
        versions={**describe_environment(), **study.finding.versions},
    )
    study = replace(study, finding=finding, calibrated_file=start.text if start else '')
    text = start.text if start else _read_vehicle_file(request)
    base = BaseFile(text, start.vehicle if start else vehicle)
    # Last, so that it changes nothing that was found before
    return add_law(study, base, tell)


def _go_on_from(
    first: FirstStep, request: DiscoveryRequest, vehicle: Vehicle
) -> tuple[CalibratedStart | None, list[str]]:
    """Return the calibrated vehicle if the flights call for a calibration, and warnings."""
    calibration = first.calibration
    if calibration is None:
        return None, [format_lift_warning(first.lifts)] if first.lifts else []
    text = _read_vehicle_file(request)
    source = format_calibration_source(calibration.bags['train'], read_commit() or 'unknown')
    try:
        return build_calibrated_start(text, vehicle, calibration, source), []
    except BadInput as fault:
        return None, [
            f'The vehicle file is off ({"; ".join(list_differences(calibration))}), but it was '
            f'studied as it is, because the calibrated file cannot be written. {fault}'
        ]


def _read_vehicle_file(request: DiscoveryRequest) -> str:
    """Return the text of the vehicle file."""
    return find_file('vehicle', request.vehicle).read_text(encoding='utf-8')


def _list_baseline_flights(study: DiscoveryStudy, sound: UsableFlights) -> list[BaselineFlight]:
    """Return the training and confirming flights under the model of the vehicle file."""
    fit_flights = [
        one for role in ('train', 'confirm') for one in study.flights if one.role == role
    ]
    out = []
    for one, fit in zip(fit_flights, study.bare, strict=True):
        before = unchanged_vehicle_point(study.nominal, one.flight.knobs, one.flight.replay.cut)
        out.append(BaselineFlight(one.name, one.flight, before, fit, sound.light.get(one.name)))
    return out


def write_results(
    request: DiscoveryRequest,
    vehicle: Vehicle,
    study: DiscoveryStudy,
    sound: UsableFlights,
    folder: Path,
    part: Path,
) -> DiscoveryResult:
    """Write the results of a study into the staging folder `part`."""
    finding = study.finding
    text = study.calibrated_file
    if text:
        (part / CALIBRATED).write_text(text, encoding='utf-8')
    else:
        text = _read_vehicle_file(request)
    learned = finding.law.file if finding.law else ''
    if draw_conclusion(finding).has_learned_file and not learned:
        learned = format_learned_vehicle(text, vehicle, study.nominal, study.learned, finding)
    if learned:
        (part / VEHICLE).write_text(learned, encoding='utf-8')
    if study.refitted is not None:
        whole = _format_refitted_vehicle(text, vehicle, study, study.refitted)
        if whole:
            (part / REFITTED).write_text(whole, encoding='utf-8')
        else:
            finding = forget_refit(finding)
            study = replace(study, finding=finding)
    write_overlay(study.comparisons, part, finding.versions)
    content = to_dict(finding, sound.cuts)
    write_json(content, part / NAME)
    bags: dict[str, Sequence[Path | str]] = {
        role: list(request.bags[role]) for role in request.bags
    }
    views = build_flight_views(study)
    drawing = animation.draw_animation(finding, views, vehicle)
    report = build_report(study, views, folder, bags, vehicle, drawing)
    write_file(render_report(report), part / PAGE)
    if drawing:
        (part / animation.NAME).write_text(drawing, encoding='utf-8')
    return DiscoveryResult(study, content, folder / PAGE)


def _format_refitted_vehicle(
    text: str, vehicle: Vehicle, study: DiscoveryStudy, refitted: NominalVehicle
) -> str:
    """Return the vehicle file with all numbers refitted; '' if a vehicle file cannot hold them."""
    finding = study.finding
    try:
        whole = format_learned_vehicle(text, vehicle, study.nominal, refitted, finding)
        fit_flights = [one.flight for one in study.flights if one.role != 'holdout']
        return add_validity(whole, fit_flights, vehicle.rotor_names, format_source(finding))
    except BadInput:
        # Forecasts may ask for a negative drag
        return ''
