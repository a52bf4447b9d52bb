"""
Score how often a wrong import is found, and whether the reason is the real one.

Flights are imported as they are and with one mistake in the mapping: lengths 1000 times too large
or small, angles in the wrong unit, times in the wrong unit, z upside down, broken motor commands.
`lta bag check` must find each mistake and name it, and nothing in the clean imports. Flights:
simulated ones, RGBlimp and a Crazyflie in LTA_DATA.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
import copy
from pathlib import Path
import re
import tempfile
from typing import Any, Final, NamedTuple

from lta_config.files import find_file
from lta_data.bag.recorded_flight import open_flight
from lta_data.data_quality.recording import read_recording
from lta_data.data_quality.registry import run_checks
from lta_data.importers.run import import_logs, ImportProgress, ImportRequest
import numpy as np
from rich.console import Console
import yaml

from campaigns import trust_flights
from campaigns.harness import Campaign, Case, Row, Rows

DEGREES: Final = 180.0 / np.pi
Mapping = dict[str, Any]


class WrongImport(NamedTuple):
    """A mistake: its kind, a variant of it, and the mapping, or None where it cannot occur."""

    kind: str
    variant: str
    change: Callable[[Mapping], Mapping | None]


def scale_lengths(factor: float, velocity: bool) -> Callable[[Mapping], Mapping | None]:
    def change(mapping: Mapping) -> Mapping | None:
        for entry in mapping['topics']:
            for part in ('position', 'velocity') if velocity else ('position',):
                if part in entry and entry['topic'].endswith('odom'):
                    entry[part]['scale'] = entry[part].get('scale', 1.0) * factor
        return mapping

    return change


def scale_angles(to_degrees: bool, angles: bool, rates: bool) -> Callable[[Mapping], Any]:
    def change(mapping: Mapping) -> Mapping | None:
        factor = DEGREES if to_degrees else 1.0 / DEGREES
        changed = False
        for entry in mapping['topics']:
            turn = entry.get('orientation', {})
            if angles and 'euler' in turn and entry['topic'].endswith('odom'):
                # Columns of the same angles in the other unit
                turn['euler'] = [f'{c}{"@deg" if to_degrees else "@rad"}' for c in turn['euler']]
                changed = True
            if rates and 'rates' in entry and entry['topic'].endswith('odom'):
                entry['rates']['scale'] = entry['rates'].get('scale', 1.0) * factor
        return mapping if changed or not angles else None

    return change


def scale_time(factor: float) -> Callable[[Mapping], Mapping | None]:
    def change(mapping: Mapping) -> Mapping | None:
        time = mapping['time']
        if 'rate' in time:
            time['rate'] = f'{float(time["rate"].split()[0]) / factor:.17g} Hz'
        else:
            time['unit'] = {1e-3: 'ms', 1e3: 's'}[factor]
            if factor > 1.0:
                time['column'] += '@ms'
        return mapping

    return change


def flip_axes(world: bool, body: bool) -> Callable[[Mapping], Mapping | None]:
    def change(mapping: Mapping) -> Mapping | None:
        down = 'world' in mapping
        for name, wrong in (('world', world), ('body', body)):
            if not wrong:
                continue
            if down:
                mapping.pop(name)
            else:
                mapping[name] = ['x', '-y', '-z'] if name == 'world' else 'FRD'
        return mapping

    return change


def break_motors(kind: str) -> Callable[[Mapping], Mapping | None]:
    def change(mapping: Mapping) -> Mapping | None:
        for entry in mapping['topics']:
            if entry['topic'] == 'motors':
                duties = [one['effort'] for one in entry['actuators'].values() if 'effort' in one]
                if any(effort.get('unit') == 'N' for effort in duties):
                    return None
                for effort in duties:
                    effort['column'] += f'@{kind}'
                return mapping
        return None

    return change


WRONG: Final = (
    *(WrongImport('1000 x too large', words, scale_lengths(1e3, both))
      for words, both in (('position', False), ('all lengths', True))),
    *(WrongImport('1000 x too small', words, scale_lengths(1e-3, both))
      for words, both in (('position', False), ('all lengths', True))),
    *(WrongImport('degrees as radians', words, scale_angles(True, True, rates))
      for words, rates in (('angles', False), ('angles and rates', True))),
    *(WrongImport('radians as degrees', words, scale_angles(False, True, rates))
      for words, rates in (('angles', False), ('angles and rates', True))),
    WrongImport('seconds as milliseconds', 'all', scale_time(1e-3)),
    WrongImport('milliseconds as seconds', 'all', scale_time(1e3)),
    *(WrongImport('z down as z up or back', words, flip_axes(world, body))
      for words, world, body in (('both', True, True), ('world', True, False),
                                 ('body', False, True))),
    WrongImport('corrupt PWM', 'spikes', break_motors('spikes')),
    WrongImport('percent as duty', 'all', break_motors('percent')),
)  # fmt: skip
# What the evidence of the right finding says, by kind; 'impossible' names no unit
RIGHT: Final = {
    '1000 x too large': r'looks like mm|1000 times too large',
    '1000 x too small': r'1000 times too small',
    'degrees as radians': r'looks like deg[:, .]|57.3 times too large',
    'radians as degrees': r'57.3 times too small',
    'seconds as milliseconds': r'1000 times too short',
    'milliseconds as seconds': r'1000 times too long',
    'z down as z up or back': r'points down|upside down|inverted|gravity along -z|z axis',
    'corrupt PWM': r'a duty is between',
    'percent as duty': r'looks like %',
}


# Flights: columns in SI, with the same numbers in other units beside them


class LabFlight(NamedTuple):
    """A flight: name, where from, columns by name, and its right mapping."""

    name: str
    group: str
    columns: dict[str, np.ndarray]
    mapping: Mapping


def add_units(columns: dict[str, np.ndarray], mapping: Mapping) -> None:
    """Add the columns that a wrong mapping would meet."""
    rng = np.random.default_rng(len(columns))
    for entry in mapping['topics']:
        for column in entry.get('orientation', {}).get('euler', ()):
            columns[f'{column}@deg'] = columns[column] * DEGREES
            columns[f'{column}@rad'] = columns[column] / DEGREES
        for actuator in entry.get('actuators', {}).values():
            if 'effort' not in actuator:
                continue
            column = actuator['effort']['column']
            values = columns[column]
            broken = values.copy()
            at = rng.random(len(values)) < rng.uniform(0.002, 0.1)
            top = actuator['effort'].get('over', 1.0)
            broken[at] = top * rng.uniform(1.5, 60.0, int(at.sum()))
            columns[f'{column}@spikes'] = broken
            columns[f'{column}@percent'] = values * 100.0
    if 'column' in mapping['time']:
        columns[f'{mapping["time"]["column"]}@ms'] = columns[mapping['time']['column']] * 1000.0


def published(path: Path, name: str) -> LabFlight:
    """Return a published flight with its shipped mapping, and Euler angles for quaternions."""
    table = np.genfromtxt(path, delimiter=',', names=True)
    columns = {column: table[column] for column in table.dtype.names}
    mapping = yaml.safe_load(find_file('import mapping', name).read_text())
    if name == 'nanobench':
        mapping['topics'][0]['orientation'] = {
            'euler': ['yaw', 'pitch', 'roll'], 'sequence': 'ZYX', 'unit': 'rad',
        }  # fmt: skip
        columns['t'] = columns['t'] - columns['t'][0] + 100.0
    return LabFlight(path.name.split('.')[0], name, columns, mapping)


def simulated(seed: int) -> LabFlight | None:
    """Return a simulated flight with a tracker's pose; None if the seed has none."""
    recording = trust_flights.simulated(seed)
    channels = recording.channels
    base = 'ground_truth/odom/'
    if f'{base}pose.pose.position.x' not in channels or 'data' not in recording.provenance:
        return None
    time = channels[f'{base}pose.pose.position.x'].time
    columns = {'t': time + 100.0}
    parts = {
        'position': ('pose.pose.position', 'xyz'), 'velocity': ('twist.twist.linear', 'xyz'),
        'rates': ('twist.twist.angular', 'xyz'),
    }  # fmt: skip
    truth: Mapping = {'topic': 'ground_truth/odom'}
    for part, (path, axes) in parts.items():
        names = [f'{part}_{axis}' for axis in axes]
        for one, axis in zip(names, axes, strict=True):
            columns[one] = channels[f'{base}{path}.{axis}'].values
        unit = {'position': 'm', 'velocity': 'm/s', 'rates': 'rad/s'}[part]
        truth[part] = {'columns': names, 'unit': unit}
    for angle in ('yaw', 'pitch', 'roll'):
        columns[angle] = channels[f'{base}pose.pose.orientation.{angle}'].values
    truth['orientation'] = {'euler': ['yaw', 'pitch', 'roll'], 'sequence': 'ZYX', 'unit': 'rad'}
    topics = [truth]
    if 'imu/angular_velocity.x' in channels:
        entry: Mapping = {'topic': 'imu'}
        for part, path, unit in (('rates', 'angular_velocity', 'rad/s'),
                                 ('acceleration', 'linear_acceleration', 'm/s2')):  # fmt: skip
            for axis in 'xyz':
                channel = channels[f'imu/{path}.{axis}']
                columns[f'{part}_imu_{axis}'] = np.interp(time, channel.time, channel.values)
            entry[part] = {'columns': [f'{part}_imu_{axis}' for axis in 'xyz'], 'unit': unit}
        topics.append(entry)
    # Motors that stand still have no unit
    duties = [
        name
        for name, channel in channels.items()
        if name.startswith('motors/effort.') and np.abs(channel.values).max() > 0.05
    ]
    if duties:
        actuators = {}
        for name in duties:
            channel, short = channels[name], name.removeprefix('motors/effort.')
            # A rotor can be called yaw
            columns[f'duty_{short}'] = np.interp(time, channel.time, channel.values)
            actuators[short] = {'effort': {'column': f'duty_{short}'}}
        topics.append({'topic': 'motors', 'actuators': actuators})
    mapping = {'schema': 1, 'name': 'simulated', 'about': 'x', 'format': 'numpy',
               'time': {'column': 't', 'unit': 's'}, 'topics': topics}  # fmt: skip
    return LabFlight(f'simulated-{seed}', 'simulated', columns, mapping)


def open_lab_flight(case: Case) -> LabFlight | None:
    """Return the flight of a case; None where a seed has no pose."""
    if case.kind == 'simulated':
        return simulated(7000 + case.number)
    files = LABS[case.kind]()
    # Neighbours are repeats of one input
    return published(files[7 * case.number % len(files)], case.kind)


def check_import(flight: LabFlight, mapping: Mapping) -> list[Any]:
    """Import columns by a mapping, check the bag, and return the grave findings."""
    with tempfile.TemporaryDirectory() as folder:
        source, form = Path(folder) / 'flight.npz', Path(folder) / 'mapping.yaml'
        np.savez(source, **flight.columns)
        mapping = {**mapping, 'format': 'numpy'}
        mapping.pop('text', None)
        form.write_text(yaml.safe_dump(mapping))
        with ImportProgress(Console(quiet=True), 1) as progress:
            import_logs(ImportRequest([source], str(form)), Path(folder) / 'out', progress)
        recording, _ = read_recording(open_flight(Path(folder) / 'out' / 'bag'))
        return [one for one in run_checks(recording).findings if one.is_grave]


def judge(kind: str, findings: list[Any]) -> tuple[bool, bool]:
    """Return whether anything is found, and whether the reason is the real one, and no other."""
    right = [one for one in findings if re.search(RIGHT[kind], one.evidence)]
    other = [one for one in findings if one not in right and one.kind in ('unit', 'axes')]
    return bool(findings), bool(right) and not other


def run(case: Case, options: Namespace) -> Row:
    """Return what is found in each wrong import of a flight: anything, and the real reason."""
    flight = open_lab_flight(case)
    if flight is None:
        return {'found': {}}
    add_units(flight.columns, flight.mapping)
    found = {'clean': (bool(check_import(flight, copy.deepcopy(flight.mapping))), False)}
    for wrong in WRONG:
        mapping = wrong.change(copy.deepcopy(flight.mapping))
        if mapping is not None and wrong.kind in options.mistakes:
            name = f'{wrong.kind}, {wrong.variant}'
            found[name] = judge(wrong.kind, check_import(flight, mapping))
    return {'found': found}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield how many wrong imports of each kind were found, and found for the real reason."""
    groups = list(dict.fromkeys(case.kind for case in rows))
    yield f'| mistake | {" | ".join(f"{one}: found, with the reason, of" for one in groups)} |'
    yield '|---' * (1 + len(groups)) + '|'
    tables = {
        group: [
            row['found'] for case, row in rows.items() if case.kind == group and 'found' in row
        ]
        for group in groups
    }
    for kind in ('clean', *dict.fromkeys(wrong.kind for wrong in WRONG)):
        cells = []
        for some in tables.values():
            pairs = [pair for one in some for name, pair in one.items() if name.startswith(kind)]
            cells.append(f'{sum(a for a, _ in pairs)}, {sum(b for _, b in pairs)}, {len(pairs)}')
        yield f'| {kind} | {" | ".join(cells)} |'


def add_arguments(parser: ArgumentParser) -> None:
    """Add the choice of mistakes."""
    kinds = list(dict.fromkeys(wrong.kind for wrong in WRONG))
    parser.add_argument('--mistakes', nargs='*', default=kinds, choices=kinds, metavar='KIND')


LABS: Final = {
    'nanobench': trust_flights.crazyflie_files, 'rgblimp': trust_flights.rgblimp_files,
}  # fmt: skip
CAMPAIGN: Final = Campaign(
    lambda options: ['simulated', *(name for name, files in LABS.items() if files())],
    run, list_table, each=20, add_arguments=add_arguments,
    smoke='--kinds simulated --first 1 --each 1 --mistakes',
)  # fmt: skip
