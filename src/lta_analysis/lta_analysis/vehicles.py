# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Create, show, check, compare and draw vehicles: the `lta vehicle` commands."""

from collections.abc import Mapping
from pathlib import Path
import sys
from typing import Any, final

from lta_analysis.console import print_lines
from lta_config.atomic_file import stage_results
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.request import (
    Action,
    argument,
    Charge,
    Folder,
    Force,
    Length,
    Mass,
    option,
    Outcome,
    ROBOT,
    VEHICLE_NAME,
)
from lta_report.results_folder import format_page_line, write_file
from lta_vehicle.vehicle_estimate import MOTOR_LAYOUTS
from rich.console import Console

LOWEST_ALTITUDE = 0.5  # m, of a mission by default
NEEDED_SIZES = ('diameter', 'mass', 'thrust', 'arm')


@final
class NewVehicleRequest(Action, command='vehicle new'):
    """
    Create a vehicle file from what you can weigh and measure, or copy an existing one.

    From size, mass and motors follow volume, lift, ballast, inertia and added mass, and an
    estimate of the drag. All other numbers are assumed, with a range, and marked so in the file.
    Gains that fit are written beside it, so that it flies at once. With --from, the file is a copy
    with its comments, under a new name. Existing files are not overwritten.

    Measure next what the file marks as assumed ("lta vehicle show --sources"); what a scale and a
    ruler do not tell, the flights of "lta tests plan" do.

    Example: lta vehicle new my_blimp --length 1.2m --diameter 0.5m --mass 120g --motors 3 --thrust
    0.1N --arm 0.2m
    """

    name: str = argument('Name of the new vehicle, for example my_blimp.')
    model: str | None = option(
        'Copy this vehicle (name or file) instead.', default=None, name='from', metavar='VEHICLE'
    )
    diameter: Length | None = option(
        "Diameter of the envelope: '50 cm'.", default=None, low=0.1, high=20.0, unit='m'
    )
    length: Length | None = option(
        'Length of a cigar; without it and --height, a sphere.', default=None, low=0.1, high=50.0,
        unit='m',
    )  # fmt: skip
    height: Length | None = option(
        'Height of a flattened balloon.', default=None, low=0.1, high=50.0, unit='m'
    )
    mass: Mass | None = option(
        'Mass of everything without gas and ballast: what a scale shows.', default=None, low=0.01,
        high=100.0, unit='g',
    )  # fmt: skip
    motors: int = option(
        '; '.join(f'{count}: {where}' for count, where in MOTOR_LAYOUTS.items()) + '.',
        default=3, low=min(MOTOR_LAYOUTS), high=max(MOTOR_LAYOUTS),
    )  # fmt: skip
    thrust: Force | None = option(
        "Thrust of one motor at full: '0.1 N'.", default=None, low=1e-3, high=100.0, unit='N'
    )
    arm: Length | None = option(
        'Distance of the side motors from the middle.', default=None, low=0.01, high=4.9, unit='m'
    )
    hang: Length | None = option(
        'Depth of the gondola with the motors below the centre of the envelope; by default 3 cm '
        'below the envelope.',
        default=None, low=0.01, high=4.9, unit='m',
    )  # fmt: skip
    envelope: Mass | None = option(
        'Mass of the empty envelope; by default from its area.', default=None, low=1e-3,
        high=100.0, unit='g',
    )  # fmt: skip
    heaviness: Mass | None = option(
        "Weight less lift after ballasting; '2 g' by default.", default=None, low=-0.1, high=1.0,
        unit='g',
    )  # fmt: skip
    battery: Charge | None = option(
        "Capacity of the battery, one cell; '250 mA h' by default.", default=None, low=3.6,
        high=3.6e5, unit='mA h',
    )  # fmt: skip
    file: Path | None = option(
        'Vehicle file to write; NAME.yaml by default.', default=None, metavar='FILE'
    )

    def run(self, console: Console) -> Outcome[Path]:
        """Write the file, and return its path."""
        path = self.file or Path(f'{self.name}.yaml')
        fields = ('length', 'height', 'hang', 'envelope', 'heaviness', 'battery', *NEEDED_SIZES)
        sizes = {key: size for key in fields if (size := getattr(self, key)) is not None}
        if sizes and self.model is None:
            self.size(path, sizes, console)
        elif sizes:
            raise BadInput(
                '--from copies a vehicle as it is; leave out --from, or '
                f'{", ".join(f"--{key}" for key in type(self).model_fields if key in sizes)}.'
            )
        else:
            self.copy_vehicle(path, console)
        return Outcome(path)

    def copy_vehicle(self, path: Path, console: Console) -> None:
        """Write a copy of another vehicle."""
        from lta_vehicle.new_vehicle import write_new_vehicle

        model = self.model or 'gtmab'
        write_new_vehicle(self.name, model, path)
        line = format_lta_command('vehicle', 'check', format_explicit_path(path))
        print_lines(
            console,
            f'File {path}',
            f'Replace the numbers copied from {model} with your own, then run: {line}',
        )

    def size(self, path: Path, sizes: Mapping[str, float], console: Console) -> None:
        """Write a vehicle of some size, and its gains."""
        from lta_vehicle.new_vehicle import describe_balance, write_sized_vehicle
        from lta_vehicle.vehicle_estimate import VehicleSize

        if missing := [f'--{key}' for key in NEEDED_SIZES if key not in sizes]:
            raise BadInput(
                f'Size, mass and motors are needed together; add {", ".join(missing)}, or copy a '
                'vehicle with --from.'
            )
        size = VehicleSize(motors=self.motors, **sizes)
        vehicle, gains = write_sized_vehicle(self.name, size, path)
        balance = f'Its gas lifts {1e3 * vehicle.gross_lift:.0f} g; {describe_balance(vehicle)}.'
        print_lines(console, f'File {path}', f'Gains {gains}', balance)
        place, stands = format_explicit_path(path), vehicle.hull_height_on_floor
        high = stands > LOWEST_ALTITUDE - 0.1
        climb = ['--set', f'mission.altitude={stands + 0.3:.1f}'] if high else []
        flies = ('Fly it', ('simulate', '--vehicle', place, *climb))
        if self.motors == min(MOTOR_LAYOUTS):
            print_lines(
                console, 'No motor pushes up, so no control law of LTA can hold its altitude.'
            )
            recorded = ('simulate', '--commands', 'BAG', '--vehicle', place)
            flies = ('Fly it by the commands of a flight', recorded)
        steps = (
            ('See its figures', ('vehicle', 'show', place)),
            flies,
            ('Measure what is assumed', ('tests', 'plan', place)),
        )
        print_lines(console, *(f'{why}: {format_lta_command(*words)}' for why, words in steps))


def format_explicit_path(path: Path) -> str:
    """Format a path so that it cannot be mistaken for a shipped name."""
    text = str(relative_path(path))
    # A word without slash and ending is taken as the name of a shipped vehicle
    return text if '/' in text or text.endswith(('.yaml', '.yml')) else f'./{text}'


@final
class VehicleSheetRequest(Action, command='vehicle show', json=True):
    """
    Show the properties and performance of a vehicle, and the source of each number.

    Mass by layer and part; centre of gravity; hover duty; thrust along each axis; speeds; pitch
    stability and tumbling; the helium loss at which it can no longer hover and, with --gains
    (about ten flights), at which its gains fail. Numbers that were neither measured nor published
    are marked as assumed. The page (--out) adds three views and works offline.

    Example: lta vehicle show gtmab --out runs/gtmab
    """

    name: str = VEHICLE_NAME
    out: Folder | None = option(
        'Folder of the page and of vehicle.json; nothing is written by default.', default=None,
        metavar='FOLDER',
    )  # fmt: skip
    gains: bool = option(
        'Simulate flights to find the loss of lift at which the controller gains fail.',
        default=False,
    )
    sources: bool = option('List every number of the vehicle file with its source.', default=False)
    pictures: Path | None = option(
        'Write each figure as PNG to this folder; needs Chromium.', default=None, metavar='FOLDER'
    )

    def run(self, console: Console) -> Outcome[Any]:
        """Print the sheet, write its page, and return its numbers."""
        from lta_analysis.door import check_picture_output
        from lta_report.report_page import PAGE, write_report
        from lta_vehicle.figures.sheet import build_sheet
        from lta_vehicle.validation import find_warnings
        from lta_vehicle.views.report import build_report
        from lta_vehicle.views.sheet_summary import show_sheet

        if self.pictures is not None and self.out is None:
            raise BadInput('--pictures needs the page; give its folder with --out.')
        check_picture_output(self.pictures)
        vehicle = load_vehicle(self.name)
        # Only on request, since it takes about ten flights
        sheet = build_sheet(vehicle, find_helium_limit(self.name, console) if self.gains else None)
        # Without the note on assumed numbers, which the sheet shows anyway
        report = build_report(sheet, find_warnings(sheet), self.name, self.sources)
        if self.out is not None:
            with stage_results(self.out.absolute(), PAGE) as part:
                write_report(report, part, pictures=self.pictures)
        show_sheet(sheet, report, console)
        if self.out is not None:
            print_lines(console, format_page_line(self.out.absolute() / PAGE))
        return Outcome(report.data)


def find_helium_limit(name: str, console: Console) -> float:
    """Return the loss of lift up to which the gains hold [kg]; print each step of the search."""
    from lta_control.laws import load_gains
    from lta_studies.tune.helium_limit import find_tolerable_helium_loss
    from lta_studies.tune.run import select_start_gains

    def print_step(loss: float, holds: bool) -> None:
        word = 'work' if holds else 'fail'
        print_lines(console, f'{1e3 * loss:6.1f} g of lift lost: the controller gains {word}')

    gains = load_gains(select_start_gains(name, None))
    limit = find_tolerable_helium_loss(name, gains, tell=print_step)
    # g to kg; None means that the gains fail without any loss
    return 0.0 if limit.grams is None else 1e-3 * limit.grams


@final
class VehicleCheckRequest(Action, command='vehicle check', json=True):
    """
    Report all errors and warnings of a vehicle file.

    Warnings: unstable balance, too little lift from the rotors, small margins, a hull that does
    not fit its gas volume, slipstreams that do not fit their rotors, assumed numbers.

    Exit status 0: valid, possibly with warnings. 2: the vehicle cannot fly.

    Example: lta vehicle check my_blimp.yaml
    """

    name: str = VEHICLE_NAME

    def run(self, console: Console) -> Outcome[dict[str, Any]]:
        """Print faults and warnings, and return them."""
        from lta_vehicle.validation import validate_vehicle_file
        from lta_vehicle.views.sheet_summary import show_warnings

        path = find_file('vehicle', self.name)
        result = validate_vehicle_file(path)
        for fault in result.faults:
            # PATH: MESSAGE, the format that editors recognise
            sys.stderr.write(f'{path}: {fault}\n')
        show_warnings(result.warnings, console)
        if not result.faults:
            print_lines(console, f'{path} is a valid vehicle file.')
        findings = {'file': str(path), 'faults': result.faults, 'warnings': result.warnings}
        # A faulty file is bad input
        return Outcome(findings, status=2 if result.faults else 0)


@final
class VehicleEditRequest(Action, command='vehicle set'):
    """
    Set numbers in a vehicle file, with their source; comments and order stay.

    Paths are those of --set. Warns if a number changed and its source did not. The file is
    replaced only if the result is a valid vehicle.

    Example: lta vehicle set my_blimp.yaml 'trim.heaviness=3 g' --source 'kitchen scale'
    """

    file: Path = argument('Vehicle file to change.')
    changes: tuple[str, ...] = argument(
        "Numbers to set: 'trim.heaviness=3 g'.", metavar='PATH=VALUE...'
    )
    source: str | None = option(
        "Source of these numbers, such as 'kitchen scale'; by default the file's stay.",
        default=None,
    )

    def run(self, console: Console) -> Outcome[Path]:
        """Change the file, and return its path."""
        from lta_vehicle.number_edit import edit_vehicle_file

        for edit in edit_vehicle_file(self.file, self.changes, self.source):
            source = f', source: {edit.source}' if edit.source else ''
            print_lines(console, f'{edit.path}: {edit.before} -> {edit.after}{source}')
            if edit.is_stale:
                print_lines(
                    console,
                    f'! {edit.path} changed, but its source is still "{edit.source}"; name the '
                    'new one with --source.',
                )
        return Outcome(self.file)


@final
class VehicleDifferenceRequest(Action, command='vehicle diff', json=True):
    """
    Compare two vehicles: the differences of their files and of the derived quantities.

    --set tries a change without a file: --set 'trim.heaviness=4 g'.

    Example: lta vehicle diff gtmab --set 'layers.propulsion_and_control.battery.mass=14 g'
    """

    name: str = VEHICLE_NAME
    other: str | None = argument(
        'Vehicle to compare with; by default the first, changed by --set.', default=None,
        metavar='[OTHER]',
    )  # fmt: skip
    changes: tuple[str, ...] = option(
        'Override a parameter of the second vehicle; repeatable.', default=(), name='set',
        metavar='PATH=VALUE',
    )  # fmt: skip

    def run(self, console: Console) -> Outcome[Any]:
        """Print the differences, and return them."""
        from lta_vehicle.difference import compare_vehicles, load_vehicle_variant
        from lta_vehicle.views.sheet_summary import encode_difference, show_difference

        if self.other is None and not self.changes:
            raise BadInput('There is nothing to compare with; give a second vehicle or --set.')
        # Without a second vehicle, compare the first with its changed self
        second = self.other or self.name
        variant = load_vehicle_variant(second, self.changes)
        difference = compare_vehicles(load_vehicle(self.name), variant)
        label = f'{second} changed' if self.changes else second
        show_difference(difference, (self.name, label), console)
        return Outcome(encode_difference(difference))


@final
class TrimRequest(Action, command='vehicle trim', json=True):
    """
    Estimate a vehicle's heaviness from a flight, and the ballast to add or remove.

    Finds intervals of steady hover and equates the weight with the rotor thrust there, or with a
    commanded force (`wrench_command`) where no duties were recorded. 20 s of
    hover in still air give a standard error of 0.1 g. In a real flight the error of the thrust
    curve adds to that and is reported.

    Example: lta vehicle trim runs/20261120-lamp_room-1
    """

    bag: Path = argument('Bag folder, results folder or .mcap file.')
    vehicle: str | None = option(
        "Flown vehicle, name or file; by default the bag's.", default=None
    )
    robot: str | None = ROBOT

    def run(self, console: Console) -> Outcome[dict[str, Any]]:
        """Print the estimate, and return it."""
        from lta_bag.bag_folder import find_bag
        from lta_data.bag.recorded_flight import open_flight
        from lta_data.scene import parse_provenance_file
        from lta_vehicle.flight_record import read_flight_record
        from lta_vehicle.trim import describe_heaviness, encode_heaviness, estimate_heaviness

        path = find_bag(self.bag)
        flight = open_flight(path, self.robot)
        # Bags of LTA contain the vehicle file that was flown
        own = parse_provenance_file(VehicleFile, flight.bag.provenance, 'vehicle_file')
        if self.vehicle is not None:
            vehicle = load_vehicle(self.vehicle)
        elif own is not None:
            vehicle = Vehicle(own)
        else:
            raise BadInput(f"'{path}' does not contain a vehicle file; name one with --vehicle.")
        where, commands, topic = read_flight_record(flight, vehicle)
        estimate = estimate_heaviness(vehicle, where, commands)
        # Only simulated flights store a scenario
        simulated = 'scenario_file' in flight.bag.provenance
        name = vehicle.file.name
        print_lines(console, describe_heaviness(estimate, name, simulated))
        facts = {'vehicle': name, 'poses': topic, 'simulated': simulated}
        return Outcome({**facts, **encode_heaviness(estimate)})


@final
class UrdfRequest(Action, command='vehicle urdf'):
    """
    Print a vehicle as URDF, for RViz, Foxglove and robot_state_publisher.

    Links match the message frames: base_link at the hull centre with all visuals, the sensors,
    rotor_NAME for each rotor, and cg_link with mass and inertia. Aerodynamic added mass is not
    included.

    Example: lta vehicle urdf gtmab --file gtmab.urdf
    """

    name: str = VEHICLE_NAME
    file: Path | None = option(
        'URDF file to write; printed by default.', default=None, metavar='FILE'
    )

    def run(self, console: Console) -> Outcome[str]:
        """Print or write the text, and return it."""
        from lta_bridge.description.urdf import build_urdf

        text = build_urdf(load_vehicle(self.name))
        if self.file is None:
            # stdout may be piped to robot_state_publisher
            sys.stdout.write(text)
        else:
            write_file(text, self.file)
            print_lines(console, f'File {self.file}')
        return Outcome(text)
