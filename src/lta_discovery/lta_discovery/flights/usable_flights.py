# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Select the usable parts of recorded flights, by the checks of `lta bag check`.

Bad intervals of the flight or of one sensor are cut out. A sensor that is bad for most of the
flight is dropped; a flight with a pose or commands that are, is rejected. Faults that are effects
of the library (tracker lag, clock drift) are kept, with a warning.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_config.errors import BadInput, format_count
from lta_data.data_quality.checks import clocks, hand_motion, impossible_values
from lta_data.data_quality.free_swing import require_commands
from lta_data.data_quality.recording import QualityFinding
from lta_data.data_quality.registry import run_checks
from lta_data.even_grid import find_runs
from lta_data.scene import find_tracker_prefix
from lta_discovery.flights.bags import (
    check_same_vehicle,
    require_distinct_runs,
    Role,
    StudyRecording,
)
from lta_discovery.flights.free_swings import align_swings
from lta_discovery.flights.measured_flight import (
    FlightStreams,
    GAP,
    MeasuredFlight,
    resample_flight,
    SHORTEST_RUN,
    Stream,
)
from lta_discovery.flights.outliers import (
    clip_command_spikes,
    ExcludedInterval,
    remove_noisy_intervals,
)
from lta_discovery.flights.sentence_merger import merge_sentences
from lta_discovery.flights.streams import build_streams, convert_to_duties
from lta_discovery.flights.transients import find_transients, format_cut
from lta_discovery.model.nominal import NominalVehicle
from lta_model.vehicle import Vehicle
import numpy as np

LARGEST_BAD_SHARE: Final = 0.5  # of a flight; a channel that is bad for longer is dropped
INTERVAL_MARGIN: Final = 0.2  # s; margin cut on either side of an interval
# m above the standing height; a swinging vehicle may still touch the floor
NEAR_FLOOR: Final = 0.05
# m; clearance from a floor that the tracker does not know, so that the model has no contact there
UNKNOWN_FLOOR_CLEARANCE: Final = 0.5
LOWEST: Final = 0.01  # quantile; lower poses may be outliers
SHORT_FLIGHT: Final = 1.5  # s; of a flight; only the total length decides beyond it
SHORTEST_TRAINING: Final = 20.0  # s; of all training flights together
CALIBRATION_TIME: Final = 5.0  # s; for a calibration, to which one step or swing tells something
STEADY_DUTY: Final = 0.005  # of the largest command: standard deviation over all training flights
DRIFTING: Final = 0.1  # m; a vehicle that moves less, and turns less, is at rest
SWINGING: Final = 0.05  # rad
SATURATED_DUTY: Final = 0.98  # duty; from it on a rotor is saturated
LOST: Final = 0.02  # of the poses; more lost poses are reported
DUTY: Final = 'motors/effort.'
LATE: Final = ('lag', 'drift')  # clock faults that may be an effect of the library
# Columns of each sensor in MeasuredFlight.readings, by the prefix of its channels.
SENSOR_COLUMNS: Final = {
    'imu/angular_velocity': ('rates', slice(0, 3)),
    'imu/linear_acceleration': ('force', slice(3, 6)),
    'imu': ('', slice(0, 6)),
    'range': ('range', slice(6, 7)),
    'pressure': ('pressure', slice(7, 8)),
    'battery': ('voltage', slice(8, 8)),
}


@final
@dataclass(frozen=True, slots=True)
class UsableFlights:
    """The usable parts of flights."""

    flights: tuple[tuple[str, Role, MeasuredFlight], ...]  # input of a study
    cuts: tuple[ExcludedInterval, ...]
    warnings: tuple[str, ...]


def select_usable_flights(
    flights: Sequence[StudyRecording], vehicle: Vehicle, least: float = SHORTEST_TRAINING
) -> UsableFlights:
    """
    Return the usable parts of some flights of one vehicle.

    `least`: usable time of all training flights that is needed. [s] Raise `BadInput` if the
    flights are not usable; the message states why.
    """
    warnings = check_same_vehicle(flights, vehicle.file)
    require_distinct_runs(flights)
    if simulated := [one.name for one in flights if one.recording.is_simulated]:
        verb = 'is' if len(simulated) == 1 else 'are'
        warnings.append(
            f'{", ".join(simulated)} {verb} marked as simulated: the results do not apply to a '
            'real vehicle.'
        )
    cuts: list[ExcludedInterval] = []
    usable: list[tuple[str, Role, MeasuredFlight]] = []
    faults: dict[Role, BadInput] = {}
    streams: list[tuple[StudyRecording, FlightStreams]] = []
    for one in flights:
        try:
            require_commands(one.name, one.recording)
            flight_streams, words = _raise_to_floor(one.name, _load_streams(one, vehicle), vehicle)
            streams.append((one, flight_streams))
            warnings += words
        except BadInput as fault:
            faults.setdefault(one.role, fault)
            warnings.append(f'{fault} The flight is left out.')
    # Checked over all training flights: each alone may hold its commands
    _check_commands_move(
        [flight_streams for one, flight_streams in streams if one.role == 'train']
    )
    for one, flight_streams in streams:
        try:
            flight, own, words = _clean_flight(one, flight_streams)
        except BadInput as fault:
            faults.setdefault(one.role, fault)
            warnings.append(f'{fault} The flight is left out.')
            continue
        cuts += own
        warnings += words
        # After cutting, which may leave little
        seconds = _usable_seconds(flight)
        # A short flight is left out; an error follows only if too little remains in all.
        if seconds < SHORT_FLIGHT:
            warnings.append(
                f'{one.name}: only {seconds:.1f} s are usable, and {SHORT_FLIGHT:g} s are needed;'
                ' the flight is left out.'
            )
        elif _find_longest_run(flight) < SHORTEST_RUN:
            warnings.append(
                f'{one.name}: the usable intervals are too short; the flight is left out.'
            )
        else:
            usable.append((one.name, one.role, flight))
    _require_usable_time(flights, usable, cuts, faults, least)
    aligned, remarks = align_swings(usable, vehicle)
    warnings += remarks
    usable = [
        (name, role, flight)
        for (name, role, _), (_, _, flight) in zip(usable, aligned, strict=True)
    ]
    for role in dict.fromkeys(one.role for one in flights):
        if not any(own == role for _, own, _ in usable):
            warnings.append(f'No flight of --{role} is usable; the study goes on without it.')
    return UsableFlights(
        tuple(usable), tuple(cuts), tuple(merge_sentences(warnings, len(flights)))
    )


def _load_streams(one: StudyRecording, vehicle: Vehicle) -> FlightStreams:
    """Return the streams of a flight; raise an error if a required one is missing."""
    channels = one.recording.channels
    try:
        height = channels[f'{find_tracker_prefix(channels)}position.z'].values
        floor = vehicle.hull_height_on_floor + NEAR_FLOOR
        # A median height below the floor limit means that the tracker's zero is not the floor.
        high = np.median(height[np.isfinite(height)]) if np.isfinite(height).any() else 0.0
        near = floor if high > floor else -np.inf
        # Poses near the floor are not used, as contact forces act there
        recorded = build_streams(channels, vehicle.rotor_names, near)
        converted = convert_to_duties(
            recorded, NominalVehicle.from_vehicle(vehicle), one.recording.provenance
        )
    except BadInput as fault:
        raise BadInput(f'{one.name}: {fault}') from None
    if not np.isfinite(converted.pose.values).all(axis=1).any():
        raise BadInput(
            f'{one.name}: no pose is valid (NaN or zero quaternion); record the flight again.'
        )
    apart = np.diff(converted.pose.time)
    if len(apart) < 2 or np.median(apart) > GAP:
        rate = 1.0 / float(np.median(apart)) if len(apart) else 0.0
        raise BadInput(
            f'{one.name}: the pose was recorded at {rate:.3g} Hz, which is too slow to observe '
            f'the forces; record it at {np.ceil(1.0 / GAP):.0f} Hz or more.'
        )
    valid = np.isfinite(converted.commands.values).all(axis=1)
    return replace(
        converted,
        commands=Stream(converted.commands.time[valid], converted.commands.values[valid]),
    )


def _raise_to_floor(
    name: str, streams: FlightStreams, vehicle: Vehicle
) -> tuple[FlightStreams, list[str]]:
    """Return a flight above the floor, where its tracker shows it below, and a warning."""
    heights = streams.pose.values[:, 2]
    finite = heights[np.isfinite(heights)]
    low = float(np.quantile(finite, LOWEST))
    # Heights below zero throughout are those of an axis that points down, which is checked later
    if low >= 0.0 or finite.max() <= 0.0:
        return streams, []
    # A range reading says how high the lowest pose was; otherwise it need not be on the floor
    clear = 0.0 if 'range' in streams.others else UNKNOWN_FLOOR_CLEARANCE
    more = vehicle.hull_height_on_floor + clear - low
    values = streams.pose.values.copy()
    values[:, 2] += more
    pose = replace(streams.pose, values=values)
    return replace(streams, pose=pose, floor=streams.floor + clear), [
        f'{name}: the hull centre is up to {-low:.2f} m below the floor, so the zero of the '
        f"tracker is not on the floor. All heights were raised by {more:.2f} m; set the tracker's "
        'origin on the floor, where height matters.'
    ]


def _check_commands_move(training: Sequence[FlightStreams]) -> None:
    """Raise an error if neither the commands nor the vehicle move in any training flight."""
    several = (
        (command_streams.commands, command_streams.wrench, command_streams.mass)
        for command_streams in training
    )
    shares = [0.0]
    for kind in zip(*several, strict=True):
        arrays = [each.values for each in kind if each is not None and len(each.values)]
        if arrays:
            tables = np.vstack(arrays)
            scale = float(np.abs(tables).max())  # duties, newtons or metres
            shares.append(float(tables.std(axis=0).max()) / scale if scale > 0.0 else 0.0)
    # Free decays, drops and pushes by hand have constant commands, and a vehicle that moves
    if (
        max(shares) < STEADY_DUTY
        and training
        and not any(_is_moving(command_streams) for command_streams in training)
    ):
        raise BadInput(
            'The commands are constant in all training flights, and the vehicle does not move; '
            'record flights with varying commands, or in which it swings, drops or drifts.'
        )


def _is_moving(streams: FlightStreams) -> bool:
    """Return whether the vehicle moves: it drifts, or swings."""
    poses = streams.pose.values[np.isfinite(streams.pose.values).all(axis=1)]
    if len(poses) < 2:
        return False
    turned = poses[:, 3:7] * np.sign(poses[:, 3:7] @ poses[0, 3:7])[:, None]
    # Twice the change of a quaternion is the angle, for small ones; percentiles ignore outliers
    moved, swung = (np.ptp(np.percentile(part, (2, 98), axis=0), axis=0).max() for part in (
        poses[:, :3], 2.0 * turned,
    ))  # fmt: skip
    return bool(moved > DRIFTING or swung > SWINGING)


def _clean_flight(
    one: StudyRecording, streams: FlightStreams
) -> tuple[MeasuredFlight, list[ExcludedInterval], list[str]]:
    """Return one flight without bad intervals, the exclusions, and warnings."""
    recording, warnings = one.recording, [f'{one.name}: {loss}' for loss in one.recording.losses]
    pose = find_tracker_prefix(recording.channels).rpartition('/')[0]
    cuts: list[ExcludedInterval] = []
    whole: list[str] = []
    smooth = []
    end = float(streams.pose.time[-1])
    streams, clipped = clip_command_spikes(streams)
    sound = bool(np.all(np.abs(streams.commands.values) <= 1.0))
    # Checks of channels that a study does not use are ignored.
    for finding in run_checks(recording).findings:
        if not finding.channel.startswith((pose, 'motors', 'wrench_command', *SENSOR_COLUMNS)):
            continue
        if finding.kind == impossible_values.KIND and finding.channel.startswith(DUTY) and sound:
            continue  # clipped
        lost = (
            finding.kind == impossible_values.KIND and impossible_values.LOST_KEY in finding.values
        )
        if lost and finding.channel.startswith((pose, *SENSOR_COLUMNS)):
            continue  # each leaves a gap of its own, and the readings between them are good
        if finding.kind == impossible_values.FILTERED:
            smooth.append(finding.channel.rpartition('/')[0])
        elif finding.is_grave and finding.kind == clocks.KIND and set(LATE) & set(finding.values):
            warnings.append(
                f'{one.name}: {finding.channel}: {finding.evidence} The data are used anyway.'
            )
        elif finding.is_grave:
            cuts.append(_exclude_interval(one.name, finding, end))
    if smooth:
        topics = ', '.join(dict.fromkeys(smooth))
        warnings.append(
            f'{one.name}: the readings of {topics} have less noise than any real sensor: they are '
            'heavily filtered, or simulated. Do not rely on results about delays and fast motion.'
        )
    streams, cuts = _drop_bad_sensors(streams, cuts, pose, whole, one.name)
    if clipped:
        warnings.append(
            f'{one.name}: {format_count(clipped, "command")} beyond what the actuators can do, '
            'for a single reading each: clipped.'
        )
    flight, warnings = resample_flight(streams), [*warnings, *whole]
    flight = _mask_intervals(flight, cuts, pose)
    for part in find_transients(flight, streams):
        inside = (flight.time >= part.from_s) & (flight.time <= part.to_s)
        cuts.append(
            ExcludedInterval(one.name, f'{pose}/pose', part.from_s, part.to_s, f'{part.reason}.')
        )
        warnings.append(f'{one.name}: {format_cut(part, float(flight.time[0]))}')
        flight = replace(flight, usable=flight.usable & ~inside)
    flight, loud = remove_noisy_intervals(one.name, flight)
    cuts += loud
    return flight, cuts, [*warnings, *_list_data_warnings(one.name, flight, streams)]


def _exclude_interval(name: str, finding: QualityFinding, end: float) -> ExcludedInterval:
    """Return the interval that a finding excludes; a clock jump excludes everything after it."""
    # After a jump of the clock all later times are wrong: exclude to the end
    jumped = finding.kind == clocks.STAMPS and {'jump', 'back'} & set(finding.values)
    begin, last = finding.from_s - INTERVAL_MARGIN, finding.to_s + INTERVAL_MARGIN
    return ExcludedInterval(
        name,
        finding.channel,
        begin,
        max(end, last) if jumped else last,
        finding.evidence,
        # Handling, detected by the accelerometer, disturbs the whole vehicle.
        disturbs_all=finding.kind == hand_motion.KIND,
    )


def _drop_bad_sensors(
    streams: FlightStreams, cuts: list[ExcludedInterval], pose: str, words: list[str], name: str
) -> tuple[FlightStreams, list[ExcludedInterval]]:
    """Drop sensors that are bad throughout; raise an error for such a pose or commands."""
    length = float(streams.pose.time[-1] - streams.pose.time[0])
    short_cuts, others = [], dict(streams.others)
    for cut in cuts:
        if cut.to_s - cut.from_s < LARGEST_BAD_SHARE * length:
            short_cuts.append(cut)
            continue
        if cut.channel.startswith((pose, 'motors', 'wrench_command')):
            raise BadInput(
                f'{name}: {cut.channel} is unreliable: {cut.reason} Without it no model can be '
                'compared with the flight; leave the flight out, or record it again.'
            )
        for start, (sensor, _) in SENSOR_COLUMNS.items():
            if cut.channel.startswith(start):
                for one in (sensor,) if sensor else ('rates', 'force'):
                    others.pop(one, None)
                words.append(f'{name}: {cut.channel} is not used: {cut.reason}')
                break
    return replace(streams, others=others), short_cuts


def _mask_intervals(
    flight: MeasuredFlight, cuts: Sequence[ExcludedInterval], pose: str
) -> MeasuredFlight:
    usable, readings = flight.usable.copy(), flight.readings.copy()
    for cut in cuts:
        inside = (flight.time >= cut.from_s) & (flight.time <= cut.to_s)
        of_all = cut.channel.startswith((pose, 'motors', 'wrench_command'))
        if of_all or cut.disturbs_all:
            usable &= ~inside
            continue
        for start, (_, columns) in SENSOR_COLUMNS.items():
            if cut.channel.startswith(start):
                readings[inside, columns] = np.nan
                break
    return replace(flight, usable=usable, readings=readings)


def _list_data_warnings(name: str, flight: MeasuredFlight, streams: FlightStreams) -> list[str]:
    """Return warnings about lost poses and saturated commands."""
    out = []
    lost = ~np.asarray(np.isfinite(flight.position).all(axis=1))
    if lost.mean() > LOST:
        gaps = int(np.sum(np.diff(lost.astype(np.int8)) > 0)) + int(lost[0])
        out.append(
            f'{name}: the tracker has no pose for {100.0 * lost.mean():.0f} % of the flight, in '
            f'{gaps} {"gap" if gaps == 1 else "gaps"}; these are not used.'
        )
    # Saturated duties do not show how thrust depends on duty
    full = np.abs(streams.commands.values) > SATURATED_DUTY
    if len(full) > 1 and full.all(axis=1).mean() > LARGEST_BAD_SHARE:
        out.append(
            f'{name}: all rotors are at full duty for {100.0 * full.all(axis=1).mean():.0f} % of '
            'the time, so their thrust at lower duty is poorly known.'
        )
    return out


def _find_longest_run(flight: MeasuredFlight) -> int:
    """Return the length of the longest usable run of a flight, in grid points."""
    return max((end - begin for begin, end in find_runs(flight.usable)), default=0)


def _usable_seconds(flight: MeasuredFlight) -> float:
    """Return the usable time of a flight [s]."""
    return float(np.sum(flight.usable) * (flight.time[1] - flight.time[0]))


def _require_usable_time(
    flights: Sequence[StudyRecording],
    usable: Sequence[tuple[str, Role, MeasuredFlight]],
    cuts: Sequence[ExcludedInterval],
    faults: Mapping[Role, BadInput],
    least: float,
) -> None:
    """Raise an error if the training flights have too little usable time."""
    seconds = sum(_usable_seconds(flight) for _, role, flight in usable if role == 'train')
    if seconds == 0.0 and 'train' in faults:
        raise faults['train']
    if seconds < least:
        names = [one.name for one in flights if one.role == 'train']
        why = dict.fromkeys(
            f'{c.flight}: {c.channel}: {c.reason}' for c in cuts if c.flight in names
        )
        raise BadInput(
            f'Only {seconds:.0f} s of the flights of --train are usable, which is too '
            f'little; record {least:.0f} s or more. {" ".join(list(why)[:2])}'.rstrip()
        )
