# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Logs of a known flight, written in a random way, are read as they were flown, or are asked about.

Columns are renamed, shuffled, rescaled, thinned out, quoted and encoded anew, beside columns that
say nothing.
"""

from collections.abc import Callable
from pathlib import Path
import random
from typing import Any

from lta_data.bag.table import stack_components
from lta_data.importers.draft.draft_mapping import draft_mapping
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .lab_flights import lab_flight, three
from .test_log_conventions import angles, Array, DEGREES, import_draft, quaternion, world_velocity

TRIALS = 24
Columns = dict[str, Array]
Flight = dict[str, Array]


def write_time(f: Flight, dice: random.Random) -> Columns:
    name = dice.choice(['t', 'time', 'timestamp', 'Time', 'stamp', 'header.stamp'])
    kind = dice.choice(['s', 'ms', 'us', 'epoch', 'ns', 'split', 'named'])
    if kind == 'split':
        count = np.round((f['t'] + 1.7e9) * 1e9).astype(np.int64)
        whole, rest = dice.choice([('sec', 'nanosec'), ('secs', 'nsecs'), ('stamp_s', 'stamp_ns')])
        return {whole: count // 10**9, rest: count % 10**9}
    if kind == 'named':
        unit, scale = dice.choice([('s', 1.0), ('ms', 1e3), ('us', 1e6)])
        return {f'{name} [{unit}]': scale * f['t']}
    if kind in ('epoch', 'ns'):
        scale = 1.0 if kind == 'epoch' else 1e9
        return {name: np.round((f['t'] + 1.7e9) * 1e9).astype(np.int64) * (scale / 1e9)}
    return {name: {'s': 1.0, 'ms': 1e3, 'us': 1e6}[kind] * (f['t'] + 3.0)}


def write_place(f: Flight, dice: random.Random, body: str) -> Columns:
    name = dice.choice(['', 'pos_', 'position.', 'p', 'Pose.Position.'])
    if dice.random() < 0.3:
        unit, scale = dice.choice([('m', 1.0), ('mm', 1e3), ('cm', 100.0)])
        return {f'{body}{name}{axis} [{unit}]': scale * f['p'][:, k]
                for k, axis in enumerate('xyz')}  # fmt: skip
    return three(body + name, dice.choice([1.0, 1e3]) * f['p'])


def write_attitude(f: Flight, dice: random.Random, body: str, has_rates: bool) -> Columns:
    turn = Rotation.from_quat(f['q'])
    kind = dice.choice(['xyzw', 'wxyz', 'numbers', 'degrees', 'radians', 'matrix'])
    if kind in ('xyzw', 'wxyz'):
        return quaternion(f, body + dice.choice(['q', 'quat_', 'orientation.']), kind)
    if kind == 'numbers':
        return {f'{body}q{k}': f['q'][:, one] for k, one in enumerate((3, 0, 1, 2))}
    if kind == 'matrix':
        return {f'{body}R{i + 1}{j + 1}': turn.as_matrix()[:, i, j]
                for i in range(3) for j in range(3)}  # fmt: skip
    names = dice.choice(['roll pitch yaw', 'phi theta psi', 'Roll Pitch Yaw'])
    words = ' '.join(body + name for name in names.split())
    # Without rates, nothing shows the sign of a pitch
    signs = dice.choice([(1, 1, 1), (1, -1, 1)]) if has_rates else (1, 1, 1)
    return angles(f, words, signs, 1.0 if kind == 'radians' else DEGREES)


def write_rates(f: Flight, dice: random.Random) -> Columns:
    name = dice.choice(['w', 'omega_', 'ang_vel_', 'gyro_', 'angular_velocity.', 'gyr.'])
    return three(name, dice.choice([1.0, DEGREES]) * f['w'])


def write_velocity(f: Flight, dice: random.Random) -> Columns:
    rows = f['v'] if dice.random() < 0.5 else world_velocity(f)
    return three(dice.choice(['v', 'vel_', 'velocity.', 'linear_velocity_']), rows)


def write_rest(f: Flight, dice: random.Random) -> Columns:
    count = len(f['t'])
    rest = {
        'temperature': np.full(count, 21.5), 'index': np.arange(count),
        'vbat': 3.9 - 1e-3 * f['t'], 'error': np.sin(3.0 * f['t']), 'rssi': np.full(count, -60.0),
    }  # fmt: skip
    return {name: rest[name] for name in dice.sample([*rest], dice.randrange(4))}


def write_text(columns: Columns, dice: random.Random) -> bytes:
    """Return a text with these columns in some dialect and encoding."""
    names = [*columns]
    if dice.random() < 0.5:
        dice.shuffle(names)
    mark, decimal = dice.choice([(',', '.'), (';', '.'), (';', ','), ('\t', '.'), ('\t', ',')])
    quote = dice.choice(['', '', '"'])
    end = dice.choice(['\n', '\r\n'])
    lines = [mark.join(f'{quote}{name}{quote}' for name in names)]
    rows = zip(*(columns[name].tolist() for name in names), strict=True)
    gap = dice.randrange(200, 900) if dice.random() < 0.3 else 0
    for k, row in enumerate(rows):
        if not gap <= k < gap + 30 or not gap:
            cells = [repr(round(one, 9)).replace('.', decimal) for one in row]
            lines.append(mark.join(f'{quote}{cell}{quote}' for cell in cells))
    if dice.random() < 0.3:
        lines.append(lines[-1][: len(lines[-1]) // 2])
    text = end.join(lines) + end * (dice.random() < 0.7)
    return text.encode(dice.choice(['utf-8', 'utf-8-sig', 'latin-1', 'utf-16']))


def write_log(seed: int) -> tuple[Flight, bytes]:
    """Return a flight, and a log of it."""
    dice = random.Random(seed)
    f = lab_flight(seed=seed % 5)
    body = dice.choice(['', '', 'blimp_', 'mocap.'])
    written = {'p', 'q', *(part for part in 'wv' if dice.random() < 0.5)}
    parts: dict[str, Callable[[], Columns]] = {
        'p': lambda: write_place(f, dice, body),
        'q': lambda: write_attitude(f, dice, body, 'w' in written),
        'w': lambda: write_rates(f, dice),
        'v': lambda: write_velocity(f, dice),
    }
    columns = write_time(f, dice)
    for part in sorted(written):
        columns |= parts[part]()
    return f, write_text(columns | write_rest(f, dice), dice)


def compare(series: Any, f: Flight) -> None:
    """Compare place and attitude with those that were flown at these times."""
    rows = np.round((series.index - series.index[0]) / 0.02).astype(int)
    place = stack_components(series, 'pose.pose.position')
    np.testing.assert_allclose(place, f['p'][rows], atol=0.01)
    attitude = Rotation.from_quat(stack_components(series, 'pose.pose.orientation'))
    apart = (attitude.inv() * Rotation.from_quat(f['q'][rows])).magnitude()
    assert np.degrees(apart).max() < 1.0


@pytest.mark.parametrize('seed', range(TRIALS))
def test_a_log_written_in_any_way_is_read_as_flown_or_asked(seed: int, tmp_path: Path) -> None:
    f, text = write_log(seed)
    source = tmp_path / 'log.csv'
    source.write_bytes(text)
    draft = draft_mapping(source, {})
    assert len(draft.choices.questions) <= 1
    if not draft.choices.questions:
        compare(import_draft(draft, source, tmp_path), f)
