# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read the bags of a study, give each a name and a role, and complete the roles."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, final, Literal

from lta_bag.bag_folder import find_bag, find_bag_files
from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import VehicleFile
from lta_data.bag.channels import read_flight
from lta_data.bag.recorded_flight import open_flight
from lta_data.data_quality.duplicate_runs import find_duplicate_runs
from lta_data.flight import Flight
from lta_data.scene import COMMAND_CHANNEL, parse_provenance_file
from lta_discovery.flights.measured_flight import MeasuredFlight
import numpy as np

Role = Literal['train', 'confirm', 'holdout']
FLIGHT_ROLES: Final[tuple[Role, ...]] = ('train', 'confirm', 'holdout')


@final
@dataclass(frozen=True, slots=True)
class StudyRecording:
    """One recorded flight."""

    name: str  # of the bag; unique within the study
    role: Role  # 'train', 'confirm' or 'holdout'
    recording: Flight

    @property
    def vehicle(self) -> str:
        """Name of the flown vehicle; '' if the recording does not state it."""
        file = parse_provenance_file(VehicleFile, self.recording.provenance, 'vehicle_file')
        return file.name if file else ''

    @property
    def rotor_names(self) -> tuple[str, ...]:
        """Names of the commanded rotors."""
        names = (n for n in self.recording.channels if n.startswith(COMMAND_CHANNEL))
        return tuple(sorted(name.removeprefix(COMMAND_CHANNEL) for name in names))


def read_bags(
    paths: Mapping[Role, Sequence[Path]],
    robot: str | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> list[StudyRecording]:
    """
    Read the flights of a study.

    `paths`: bag folders, results folders or .mcap files. Raise `BadInput` if there is no training
    flight, a recording occurs twice, or one cannot be read.
    """
    if not paths.get('train'):
        raise BadInput('There is no training flight; name one or more with --train.')
    seen: dict[Path, Role] = {}
    for role in FLIGHT_ROLES:
        for path in paths.get(role, ()):
            # Check all paths first, since reading a bag takes seconds
            _register_recording(path, role, seen)
    out: list[StudyRecording] = []
    for role in FLIGHT_ROLES:
        for path in paths.get(role, ()):
            name = _unique_bag_name(path, [one.name for one in out])
            tell(name)
            flight = open_flight(find_bag(path), robot)
            out.append(StudyRecording(name, role, read_flight(flight, raw=True)))
    return out


def _register_recording(path: Path, role: Role, roles: dict[Path, Role]) -> None:
    """Register a recording, or raise an error if it is registered already."""
    for file in find_bag_files(find_bag(path)):
        # Follow links, so that one file under two names is detected
        place = file.resolve()
        if place in roles:
            both = f'{roles[place]} and --{role}' if roles[place] != role else role
            raise BadInput(
                f"The flight '{path}' is given twice, with --{both}; give each flight only once."
            )
        roles[place] = role


def _unique_bag_name(path: Path, names: Sequence[str]) -> str:
    """Return a unique name of a bag: that of its folder, or of its results folder."""
    place = find_bag(path).resolve()
    if place.is_file():
        name = place.stem
    else:
        # In a results folder the bag is always called 'bag'; use the name of the run
        name = place.parent.name if place.name == 'bag' else place.name
    count, only = 1, name
    while name in names:
        # Number repeated names, as messages refer to flights by name.
        count += 1
        name = f'{only}_{count}'
    return name


def check_same_vehicle(flights: Sequence[StudyRecording], vehicle: VehicleFile) -> list[str]:
    """
    Check that all flights are of one vehicle; return warnings about its name.

    Raise `BadInput` if the recordings name different vehicles, or command different rotors.
    """
    # One flight per vehicle suffices to name the conflict
    by_name = {one.vehicle: one.name for one in flights if one.vehicle}
    by_rotors = {one.rotor_names: one.name for one in flights if one.rotor_names}
    for kinds, what in (
        (by_name, 'are of different vehicles'),
        (by_rotors, 'command different rotors'),
    ):
        if len(kinds) > 1:
            listing = '; '.join(
                f"'{flight}': {_format_vehicle(kind)}" for kind, flight in kinds.items()
            )
            raise BadInput(f'The flights {what} ({listing}); study one vehicle at a time.')
    other = [name for name in by_name if name != vehicle.name]
    return [
        f'The flights were recorded with the vehicle {name}, but the vehicle file is that of '
        f'{vehicle.name}; check --vehicle.'
        for name in other
    ]


def _format_vehicle(kind: str | tuple[str, ...]) -> str:
    """Return a vehicle or its rotors as words."""
    return kind if isinstance(kind, str) else ', '.join(kind)


def require_distinct_runs(flights: Sequence[StudyRecording]) -> None:
    """Raise `BadInput` if one run occurs twice, even if trimmed or rewritten."""
    again = (
        find_duplicate_runs([(one.name, one.recording) for one in flights])
        if len(flights) > 1
        else {}
    )
    for name, findings in again.items():
        raise BadInput(
            f'{name}: {findings[0].evidence} A copy of a flight cannot confirm it; leave '
            'one of them out.'
        )


AssignedFlight = tuple[str, str, MeasuredFlight]  # name, role, flight

ROLE_ENDS: Final = (0.4, 0.7)  # of the usable time: ends of the training and the confirming part
TRAINING_END: Final = 0.6  # the same, where there is a held-out flight already


def restrict_to_interval(flight: MeasuredFlight, begin: float, end: float) -> MeasuredFlight:
    """
    Return a flight of which only a part is usable.

    The whole flight is still replayed, because lag, gas and battery have memory.

    `begin`, `end`: of the usable points, 0 to 1.
    """
    # Share of the usable time up to each point
    count = np.cumsum(flight.usable) / max(1, int(flight.usable.sum()))
    return replace(flight, usable=flight.usable & (count > begin) & (count <= end))


def assign_roles(flights: Sequence[AssignedFlight]) -> tuple[list[AssignedFlight], list[str]]:
    """
    Complete the roles of flights, so that some train and some confirm.

    Returns
    -------
    list of (name, role, MeasuredFlight), list of str
        The same flights where some confirm; otherwise training flights split in two (a single one
        in time), or one flight alone split in three. Then warnings about the split.

    Raises
    ------
    BadInput
        If there is no training flight.

    """
    train = [flight for flight in flights if flight[1] == 'train']
    rest = [flight for flight in flights if flight[1] != 'train']
    if not train:
        raise BadInput('There is no training flight; name at least one with --train.')
    if any(role == 'confirm' for _, role, _ in rest):
        return list(flights), []
    if len(train) > 1:
        # With an odd number, training gets the extra flight.
        half = (len(train) + 1) // 2
        moved = [(name, 'confirm', flight) for name, _, flight in train[half:]]
        remark = 'No flight is given with --confirm, so half of the training flights confirm'
        return [*train[:half], *moved, *rest], [f'{remark} the other half.']
    name, _, flight = train[0]
    if rest:
        parts = [
            (name, 'train', restrict_to_interval(flight, 0.0, TRAINING_END)),
            (name, 'confirm', restrict_to_interval(flight, TRAINING_END, 1)),
        ]
        remark = 'No flight is given with --confirm: the last part of the training flight confirms'
        return [*parts, *rest], [f'{remark} the effects, which is weaker than another flight.']
    first, second = ROLE_ENDS
    edges = zip(FLIGHT_ROLES, (0.0, first, second), (first, second, 1.0), strict=True)
    remark = 'A single flight is split into a training, a confirming and a held-out part, which'
    return [(name, role, restrict_to_interval(flight, a, b)) for role, a, b in edges], [
        f'{remark} gives weaker evidence than three flights.'
    ]
