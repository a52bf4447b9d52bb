# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run a discovery: read the bags, calibrate where needed, study the flights, report."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, final, Self

from lta_bag.provenance import read_commit
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_discovery.calibration.calibrated_file import (
    CALIBRATED_FILE,
    format_calibrated_vehicle,
    format_calibration_source,
    format_changed_vehicle,
    VehicleUpdate,
)
from lta_discovery.calibration.first_step import calibrate_first, FirstStep
from lta_discovery.calibration.result import Calibration
from lta_discovery.calibration.verdict import format_lift_warning, list_differences
from lta_discovery.discovery.conclusion import draw_conclusion, format_names
from lta_discovery.discovery.figures import draw_picture, PICTURE
from lta_discovery.discovery.report import build_report
from lta_discovery.discovery.study import Discovery, NamedElement, study_flights, WRITTEN
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.usable_flights import select_usable_flights, UsableFlights
from lta_discovery.formatting import format_with_interval, join_words
from lta_discovery.progress import DiscoverProgress
from lta_model.vehicle import load_vehicle, parse_vehicle, Vehicle
from lta_report.report import Report
from lta_report.request import option, ReportRequest, ROBOT, StudyRun
import numpy as np

BAGS: Final = 'Bag folders, results folders or .mcap files'
CALIBRATING: Final = 0.2  # share of the calibration in the progress of a study
Tell = Callable[[str, float | None], None]


@final
class DiscoveryRequest(ReportRequest, command='discover'):
    """
    Find where a vehicle's model disagrees with its flights, and name what is missing.

    Where the flights call for it, the vehicle is calibrated first ("lta calibrate"): gains, delay,
    lift, marker frame. The search goes on from the calibrated values, and calibrated.yaml is the
    vehicle file with them.

    Effects of the library, numbers of the file that are wrong, and forces of other forms are
    compared by one posterior. A name is given if its probability is 95 % or more, with all names
    that these flights cannot tell from it. The result may also be that nothing is missing, or that
    the flights do not decide.

    Writes report.html, vehicle.yaml (the vehicle file with what is named), picture.svg and
    discovery.json.

    A single flight is split in time, which gives weaker evidence. Method and accuracy:
    docs/discovery.md.

    Exit status 0: done, whatever the result. 2: bad input, or flights too poor to analyse.

    Example: lta discover --vehicle gtmab --train A B --holdout C

    Example: lta discover --demo
    """

    vehicle: str = option(
        'Vehicle whose model is compared with the flights, name or file.', default='',
        complete='vehicle',
    )  # fmt: skip
    train: tuple[Path, ...] = option(
        f'Flights to learn from. {BAGS}.', default=(), metavar='BAG...'
    )
    confirm: tuple[Path, ...] = option(
        'Other flights of the same vehicle to learn from.', default=(), metavar='BAG...'
    )
    holdout: tuple[Path, ...] = option(
        'Flights whose forecasts judge the result; nothing is fitted.', default=(),
        metavar='BAG...',
    )  # fmt: skip
    robot: str | None = ROBOT
    demo: bool = option(
        'Demonstration: simulate flights with a hidden effect and discover it.', default=False
    )
    calibration: bool = option(
        'Calibrate the vehicle first, where the flights call for it.', default=True
    )
    seed: int = option('Random seed of --demo.', default=1, low=0, high=2**31 - 1)

    def run(self, run: StudyRun) -> Report:
        """Return the report with all files."""
        # Refuse contradictory options before any work
        if self.demo and (any(self.bags.values()) or self.vehicle):
            raise BadInput(
                '--demo simulates its own flights; remove --vehicle, --train, --confirm and '
                '--holdout.'
            )
        if not self.demo and not self.vehicle:
            raise BadInput(
                'A vehicle file to compare the flights with is missing; name one with --vehicle, '
                'or try --demo.'
            )
        with DiscoverProgress(run.console) as progress:
            if self.demo:
                from lta_discovery.demo import run_discovery_demo

                return run_discovery_demo(self.seed, run.folder, progress.show_stage)
            return discover_effects(self, progress.show_stage)

    @classmethod
    def of_bags(cls, vehicle: str, bags: Mapping[Role, Sequence[Path]]) -> Self:
        """Return the request to study flights, by what they are for, with a vehicle."""
        train, confirm, holdout = (
            tuple(bags.get(role, ())) for role in ('train', 'confirm', 'holdout')
        )
        return cls(vehicle=vehicle, train=train, confirm=confirm, holdout=holdout)

    @property
    def bags(self) -> dict[Role, Sequence[Path]]:
        """Return the flights by what they are for."""
        return {'train': self.train, 'confirm': self.confirm, 'holdout': self.holdout}


def discover_effects(request: DiscoveryRequest, tell: Tell) -> Report:
    """
    Study flights and return the report with all files.

    Raises
    ------
    BadInput
        If the flights are not usable.

    """
    vehicle = load_vehicle(request.vehicle)
    flights = read_bags(request.bags, request.robot, lambda name: tell(f'reading {name}', None))
    tell('checking data quality', None)
    usable = select_usable_flights(flights, vehicle)
    study, text, calibrated = study_usable_flights(request, vehicle, usable, tell)
    conclusion = draw_conclusion(study)
    report = build_report(study, conclusion, request.vehicle, usable.cuts, usable.warnings)
    outputs = dict[str, str | bytes]()
    if picture := draw_picture(conclusion, study.comparison):
        outputs[PICTURE] = picture
    if conclusion.writes_calibrated:
        outputs[CALIBRATED_FILE] = calibrated
    if conclusion.writes_file:
        outputs[WRITTEN] = format_learned_vehicle(text, study)
    return replace(report, outputs=outputs)


def study_usable_flights(
    request: DiscoveryRequest, vehicle: Vehicle, usable: UsableFlights, tell: Tell
) -> tuple[Discovery, str, str]:
    """
    Return the study of usable flights, and the texts of the studied and of the calibrated file.

    The latter is '' without a calibration.

    Raises
    ------
    BadInput
        If the flights cannot be studied with this vehicle file.

    """
    text = find_file('vehicle', request.vehicle).read_text(encoding='utf-8')
    calibrated, first, remarks = '', FirstStep(), tuple[str, ...]()
    try:
        if request.calibration:
            part = _tell_part(tell, 0.0, CALIBRATING)
            first = calibrate_first(vehicle, request.vehicle, usable.flights, part)
        if first.lifts:
            remarks = (format_lift_warning(first.lifts),)
        if calibration := first.compared:
            try:
                calibrated = _format_calibrated(text, vehicle, calibration)
                if first.calibration is not None:
                    # The search judges drag and added mass itself
                    rest = replace(calibration, calibrated=calibration.without_flows)
                    text = _format_calibrated(text, vehicle, rest)
                    vehicle = parse_vehicle(text, CALIBRATED_FILE)
            except BadInput as fault:
                if first.calibration is not None:
                    differences = '; '.join(list_differences(calibration))
                    remarks = (
                        f'The vehicle file is off ({differences}), but it was studied as it is, '
                        f'because the calibrated file cannot be written. {fault}',
                    )
                first = FirstStep(lifts=first.lifts)
        study = study_flights(vehicle, usable.flights, _tell_part(tell, CALIBRATING, 1.0), first)
    except (np.linalg.LinAlgError, ArithmeticError) as fault:
        names = ', '.join(name for name, _, _ in usable.flights)
        raise BadInput(
            f'The equations of the fit have no solution for {names} with {request.vehicle} '
            f'({fault}); correct the values of the vehicle file that are far off, or leave out '
            'the shortest flight.'
        ) from fault
    return replace(study, warnings=(*remarks, *study.warnings)), text, calibrated


def _tell_part(tell: Tell, begin: float, end: float) -> Tell:
    """Return how to tell the progress of a part of the whole, from its own share."""

    def tell_whole(what: str, share: float | None) -> None:
        tell(what, None if share is None else begin + (end - begin) * share)

    return tell_whole


def _format_calibrated(text: str, vehicle: Vehicle, calibration: Calibration) -> str:
    source = format_calibration_source(calibration.bags['train'], read_commit() or 'unknown')
    return format_calibrated_vehicle(text, vehicle, calibration, source)


def format_learned_vehicle(text: str, study: Discovery) -> str:
    """
    Return the text of a vehicle file with what is named, and nothing else changed.

    Raise `BadInput` if the format has no place for a number.
    """
    notes = {
        (effect, name): note
        for one in (*study.named, *study.closest)
        for effect, name, note in _list_notes(one)
    }
    source = f'lta discover from {", ".join(study.learned_from)}, commit {read_commit()}'
    change = VehicleUpdate(study.nominal, study.learned)
    return format_changed_vehicle(text, study.vehicle, change, notes, source)


def _list_notes(one: NamedElement) -> list[tuple[str, str, str]]:
    """Return effect, parameter and note for each number of an element."""
    instead = join_words([format_names(name) for name in one.alternatives], 'or')
    out = []
    for each in one.estimates:
        value, low, high = format_with_interval(each.value, each.ci95)
        note = f'{value} {each.unit}, 95 % {low} to {high}'
        effect, _, name = each.name.partition('.')
        out.append((effect, name, f'{note}; it may be {instead} instead' if instead else note))
    return out
