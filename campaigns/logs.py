# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Import flights of known truth from logs in drawn formats, names, units, orders and frames.

A flight is that of a simulated GT-MAB. Each quantity gets names, a unit and a convention at
random, columns are shuffled, others stand beside them, rows and cells are missing, and the file is
written in the format of its kind. `lta import --draft` has only the file. What it reads without a
question must be the truth; a question is counted. A traceback or a wrong reading is what must not
be.
"""

from argparse import Namespace
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
import tempfile
from typing import Final

from lta_bag.reader import read_bag
from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import open_flight
from lta_data.bag.table import stack_components
from lta_data.importers.draft.draft_mapping import draft_mapping
from lta_data.importers.run import import_logs, ImportRequest
from lta_model.vehicle import load_vehicle
from lta_report.formatting import format_markdown_table
import numpy as np
from numpy.typing import NDArray
import pandas as pd
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from campaigns.challenge.case_generator import draw_initial_state
from campaigns.challenge.flight import FlightSimulator
from campaigns.challenge.pilot import SwingingPilot
from campaigns.challenge.truth import build_vehicle_truth
from campaigns.harness import Campaign, Case, Row, Rows

Array = NDArray[np.float64]
Draw = np.random.Generator
Columns = dict[str, Array]

SECONDS: Final = 24.0  # of a flight
FLIGHTS: Final = 8  # different ones
PERIODS: Final = (0.01, 0.02, 0.05)  # s; of the rows of a log
EPOCH: Final = 1_760_000_000.0  # s
# By what a reading may be off: rounding, and the noise of what is smoothed [m, rad, m/s, rad/s]
TOLERANCE: Final = {'position': 0.02, 'attitude': 0.03, 'velocity': 0.06, 'rates': 0.12}
TO_NED: Final = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
DOWN: Final = np.array([1.0, -1.0, -1.0])  # body axes of an attitude in north, east, down
DEGREES: Final = 180.0 / np.pi

TIMES: Final = {  # units of one second
    't': 1.0, 'time': 1.0, 'Time [s]': 1.0, 'timestamp': 1e9, 'time_ms': 1e3, 't_us': 1e6,
    'stamp_ns': 1e9, 'elapsed_s': 1.0, 'Time (sec)': 1.0,
}  # fmt: skip
PLACES: Final = {
    'x y z': 1.0, 'pos_x pos_y pos_z': 1.0, 'px py pz': 1.0,
    'position.x position.y position.z': 1.0,
    'X [mm],Y [mm],Z [mm]': 1e3, 'x_mm y_mm z_mm': 1e3, 'x_cm y_cm z_cm': 100.0,
    'tx_m ty_m tz_m': 1.0, 'Position_X Position_Y Position_Z': 1.0,
    'pose.position.x pose.position.y pose.position.z': 1.0,
}  # fmt: skip
QUATERNIONS: Final = (  # names in the order x, y, z, w
    'qx qy qz qw', 'quat_x quat_y quat_z quat_w', 'q1 q2 q3 q0', 'orientation.x orientation.y '
    'orientation.z orientation.w', 'q.x q.y q.z q.w', 'rot_x rot_y rot_z rot_w',
)  # fmt: skip
ANGLES: Final = {
    'roll pitch yaw': 1.0, 'roll_deg pitch_deg yaw_deg': DEGREES, 'phi theta psi': 1.0,
    'Roll [deg],Pitch [deg],Yaw [deg]': DEGREES, 'euler_x euler_y euler_z': 1.0,
    'att_roll att_pitch att_yaw': DEGREES,
}  # fmt: skip
VELOCITIES: Final = {
    'u v w': 1.0, 'vx vy vz': 1.0, 'vel_x vel_y vel_z': 1.0,
    'vx [m/s],vy [m/s],vz [m/s]': 1.0, 'velocity.x velocity.y velocity.z': 1.0,
}  # fmt: skip
RATES: Final = {
    'wx wy wz': 1.0, 'gyro_x gyro_y gyro_z': 1.0, 'gyro_x_dps gyro_y_dps gyro_z_dps': DEGREES,
    'omega_x omega_y omega_z': 1.0, 'p q r': 1.0, 'angular_velocity.x angular_velocity.y '
    'angular_velocity.z': 1.0,
}  # fmt: skip
BESIDE: Final = (
    'index', 'battery_v', 'x_std', 'pos_sigma_x', 'temperature', 'mode', 'cpu_load',
    'position_uncertainty', 'latency_ms', 'frame_number', 'rssi',
)  # fmt: skip


@cache
def fly(number: int) -> tuple[Array, Array]:
    """Return times and states of a flight: place, world velocity, quaternion w x y z, rates."""
    truth, draw = build_vehicle_truth(load_vehicle('gtmab')), np.random.default_rng([71, number])
    pilot = SwingingPilot(SECONDS, truth, draw)
    path = FlightSimulator(truth, pilot).simulate_flight(
        draw_initial_state(pilot.heading, draw), SECONDS
    )
    return path.time, path.states


def draw_columns(draw: Draw) -> tuple[Columns, dict[str, Array]]:
    """Return the columns of a log, and the truth in our units and frames, of its rows."""
    time, states = fly(int(draw.integers(FLIGHTS)))
    grid = np.arange(time[0], time[-1], draw.choice(PERIODS))
    at = np.searchsorted(time, grid).clip(0, len(time) - 1)
    grid, states = time[at], states[at]
    turn = Rotation.from_quat(states[:, [7, 8, 9, 6]])
    is_ned = bool(draw.random() < 0.15)
    world = states[:, :3] @ TO_NED.T if is_ned else states[:, :3]
    axes = Rotation.from_matrix(TO_NED @ turn.as_matrix() @ np.diag(DOWN)) if is_ned else turn
    body = DOWN if is_ned else np.ones(3)
    velocity, rates = turn.apply(states[:, 3:6], inverse=True), states[:, 10:13]
    truth = {'time': grid, 'position': states[:, :3], 'attitude': turn.as_quat()}

    def pick(names: dict[str, float], values: Array) -> Columns:
        key = str(draw.choice(list(names)))
        split = key.split(',') if ',' in key else key.split()
        return dict(zip(split, names[key] * values.T, strict=True))

    key = str(draw.choice(list(TIMES)))
    begin = EPOCH if draw.random() < 0.3 and TIMES[key] != 1e3 else float(draw.choice([0.0, 12.5]))
    out = {key: np.round((grid - grid[0] + begin) * TIMES[key], 6 if TIMES[key] == 1.0 else 0)}
    if is_ned:
        out |= dict(zip(('north', 'east', 'down'), world.T, strict=True))
    else:
        out |= pick(PLACES, world)
    if draw.random() < 0.6:
        sign = np.sign(axes.as_quat()[0, 3]) if draw.random() < 0.5 else 1.0
        names = str(draw.choice(QUATERNIONS)).split()
        out |= dict(zip(names, sign * axes.as_quat().T, strict=True))
    else:
        out |= pick(ANGLES, axes.as_euler('ZYX')[:, ::-1])
    if draw.random() < 0.5:
        is_world = bool(draw.random() < 0.5)
        out |= pick(VELOCITIES, axes.apply(velocity * body) if is_world else velocity * body)
        truth['velocity'] = velocity
    if draw.random() < 0.5:
        out |= pick(RATES, rates * body)
        truth['rates'] = rates
    for name in draw.choice(BESIDE, int(draw.integers(4)), replace=False):
        size = 10.0 ** float(draw.uniform(-2.0, 2.0))
        out[str(name)] = np.abs(size + 0.1 * size * draw.standard_normal(len(grid)))
    return out, truth


def spoil_columns(columns: Columns, draw: Draw) -> Columns:
    """Return columns with jitter of the times, missing rows and cells, and a prefix of names."""
    (clock, times), *rest = columns.items()
    step = float(np.median(np.diff(times)))
    kept = draw.random(len(times)) > draw.choice([0.0, 0.0, 0.03])
    if draw.random() < 0.3:  # a tracker that lost the vehicle, twice
        for begin in draw.integers(len(times), size=2):
            kept[begin : begin + int(draw.integers(20))] = False
    kept[0] = True  # the rows are found again by the time after the first one
    late = step * draw.choice([0.0, 0.1]) * draw.random(len(times))
    times = times + (np.round(late) if times.dtype.kind == 'i' or step > 1.0 else late)
    prefix = str(draw.choice(['', '', 'drone_', 'vicon_', 'state.', 'Blimp/']))
    out = {clock: times[kept]} | {f'{prefix}{name}': one[kept] for name, one in rest}
    if draw.random() < 0.2:  # cells without a number
        gone = draw.random(kept.sum()) < 0.01
        gone[0] = False
        out = {name: one if name == clock else np.where(gone, np.nan, one)
               for name, one in out.items()}  # fmt: skip
    return out


def write_text(path: Path, columns: Columns, delimiter: str = ',', **how: str | int) -> Path:
    """Write a log as text."""
    pd.DataFrame(columns).to_csv(path, sep=delimiter, index=False, **how)
    return path


def write_two_bodies(path: Path, columns: Columns) -> Path:
    """Write rows of the vehicle and of a body that stands still, in turn."""
    table = pd.DataFrame(columns)
    still = table.copy()
    clock = next(iter(columns))
    still[[name for name in columns if name != clock]] = table.iloc[0].drop(clock).to_numpy()
    both = pd.concat([table.assign(body='blimp'), still.assign(body='wand')])
    return write_text(path, dict(both.sort_index(kind='stable').items()))


def write_cut(path: Path, columns: Columns) -> Path:
    """Write a log that ends within a row."""
    path.write_bytes(write_text(path, columns).read_bytes()[:-9])
    return path


def write_array(path: Path, columns: Columns) -> Path:
    """Write columns as arrays of NumPy."""
    np.savez(path.with_suffix('.npz'), **columns)
    return path.with_suffix('.npz')


def write_matlab(path: Path, columns: Columns) -> Path:
    """Write columns as variables of MATLAB, whose names are plain words."""
    plain = {''.join(c if c.isalnum() else '_' for c in name).strip('_'): one
             for name, one in columns.items()}  # fmt: skip
    savemat(path.with_suffix('.mat'), plain, oned_as='column')
    return path.with_suffix('.mat')


def write_parquet(path: Path, columns: Columns) -> Path:
    """Write columns as Parquet."""
    pd.DataFrame(columns).to_parquet(path.with_suffix('.parquet'))
    return path.with_suffix('.parquet')


WRITERS: Final[dict[str, Callable[[Path, Columns], Path]]] = {
    'commas': write_text,
    'semicolons': lambda path, columns: write_text(path, columns, ';', decimal=','),
    'tabs': lambda path, columns: write_text(path, columns, '\t'),
    'quotes': lambda path, columns: write_text(path, columns, quoting=1),
    'UTF-16': lambda path, columns: write_text(path, columns, encoding='utf-16'),
    'byte order mark': lambda path, columns: write_text(path, columns, encoding='utf-8-sig'),
    'cut': write_cut,
    'two bodies': write_two_bodies,
    'npz': write_array,
    'mat': write_matlab,
    'parquet': write_parquet,
}


def run(case: Case, options: Namespace) -> Row:
    """Draft and import a log, and compare what was read with the truth."""
    draw = np.random.default_rng([options.seed, case.number, list(WRITERS).index(case.kind)])
    columns, truth = draw_columns(draw)
    columns = spoil_columns(columns, draw)
    names = [str(name) for name in draw.permutation(list(columns))]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        source = WRITERS[case.kind](folder / 'log.csv', {name: columns[name] for name in names})
        row: Row = {'columns': names}
        try:
            draft = draft_mapping(source, {})
            if questions := [one.key for one in draft.choices.questions]:
                return row | {'outcome': 'asked', 'questions': questions}
            mapping = folder / 'mapping.yaml'
            mapping.write_text(draft.text)
            import_logs(ImportRequest([source], str(mapping)), folder / 'out')
        except BadInput as fault:
            return row | {'outcome': 'refused', 'said': str(fault)}
        flight = open_flight(read_bag(folder / 'out' / 'bag'), None)
        topic = next((one for one in ('ground_truth/odom', 'odom') if one in flight.topics), '')
        if not topic:
            return row | {'outcome': 'lost', 'topics': list(flight.topics)}
        series = flight[topic]
        read = {
            name: stack_components(series, field)
            for name, field in zip(
                TOLERANCE,
                ('pose.pose.position', 'pose.pose.orientation', 'twist.twist.linear',
                 'twist.twist.angular'), strict=True,
            )
        }  # fmt: skip
        wrong = list_wrong(series.index.to_numpy(), read, truth)
    wrong += [one for one in flight.topics if one in ('motors', 'wrench_command')]
    outcome = 'wrong' if wrong else 'right'
    return row | {'outcome': outcome, 'wrong': f'{wrong} of {names}' if wrong else ''}


def list_wrong(time: Array, read: dict[str, Array], truth: dict[str, Array]) -> list[str]:
    """Return the parts of a motion that were read, but not as they are."""
    step = float(np.median(np.diff(truth['time'])))
    at = np.round((time - time[0]) / step).astype(int).clip(0, len(truth['time']) - 1)
    out = []
    for name, tolerance in TOLERANCE.items():
        if name not in truth or not np.isfinite(read[name]).any():
            continue
        if name == 'attitude':
            both = Rotation.from_quat(read[name]).inv() * Rotation.from_quat(truth[name][at])
            error = both.magnitude()
        else:
            error = np.linalg.norm(read[name] - truth[name][at], axis=1)
        if not np.nanquantile(error, 0.9) < tolerance:
            out.append(name)
    return out


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the outcomes by the format, and how often something was asked."""
    outcomes: Sequence[str] = ('right', 'asked', 'refused', 'lost', 'wrong')
    table = []
    for kind in WRITERS:
        own = [row for case, row in rows.items() if case.kind == kind]
        count = Counter(row.get('outcome', 'wrong') for row in own)
        table.append([kind, str(len(own)), *(str(count[one]) for one in outcomes)])
    yield format_markdown_table(['format', 'logs', *outcomes], table)
    asked = Counter(key for row in rows.values() for key in row.get('questions', ()))
    several = sum(len(row.get('questions', ())) > 1 for row in rows.values())
    yield ''
    yield (
        f'More than one question: {several} logs. Questions: '
        + (', '.join(f'{key} {count}' for key, count in asked.most_common()) or 'none')
        + '.'
    )


CAMPAIGN: Final = Campaign(
    lambda options: list(WRITERS), run, list_table, each=182, page='import.md', side=0,
    smoke='--kinds commas npz --each 1',
)  # fmt: skip
