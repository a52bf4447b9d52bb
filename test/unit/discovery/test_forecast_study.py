# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A vehicle file, judged by forecasts: `lta simulate --commands --forecasts`."""

from collections.abc import Mapping
import json
import math
from pathlib import Path
import re
from typing import Any

from campaigns.challenge.recording import write_bag
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.vehicle_edit import set_yaml_values
from lta_discovery.flights.bags import read_bags
from lta_discovery.flights.usable_flights import CALIBRATION_TIME, select_usable_flights
from lta_discovery.forecast_study import build_report, ForecastStudy, study_forecasts
from lta_discovery.state_filter.forecast_scores import COASTING, FILE_MODEL
from lta_discovery.state_filter.forecasts import FlightForecasts
from lta_model.vehicle import load_vehicle
from lta_report.report_page import render_report
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

Bags = tuple[Path, Path, Path]
Array = NDArray[np.float64]
PERIOD = 0.04  # s; of the grid
HALF = 0.5  # s; from which coasting begins


@pytest.fixture(scope='module')
def studied(hidden_bags: Bags) -> ForecastStudy:
    return study_forecasts('gtmab', hidden_bags[:2])


@pytest.fixture(scope='module')
def rows(studied: ForecastStudy) -> list[dict[str, Any]]:
    return studied.list_rows()


def test_coasting_keeps_the_twist_of_the_past_half_second(
    hidden_bags: Bags, rows: list[dict[str, Any]]
) -> None:
    """Least squares with NumPy, and the exponential of the twist with SciPy, from poses alone."""
    usable = select_usable_flights(
        read_bags({'train': hidden_bags[:2]}), load_vehicle('gtmab'), CALIBRATION_TIME
    )
    flights = {name: flight for name, _, flight in usable.flights}
    for row in rows:
        flight, start = flights[row['flight']], row['start_s']
        time = flight.time - start
        past = (time > -HALF) & (time < 0.5 * PERIOD) & np.isfinite(flight.position[:, 0])
        now, then = np.argmin(np.abs(time)), np.argmin(np.abs(time - row['horizon_s']))
        turns = Rotation.from_quat(flight.quaternion[past])
        here, there = (Rotation.from_quat(flight.quaternion[k]) for k in (now, then))
        poses = np.column_stack([flight.position[past], (here.inv() * turns).as_rotvec()])
        line = np.column_stack([time[past], np.ones(past.sum())])
        slope, begin = np.linalg.lstsq(line, poses, rcond=None)[0]
        # The line has the mean velocity of the half second
        middle = here * Rotation.from_rotvec(begin[3:] + time[past].mean() * slope[3:])
        pose, twist = np.eye(4), np.zeros((4, 4))
        pose[:3, :3] = (here * Rotation.from_rotvec(begin[3:])).as_matrix()
        pose[:3, 3] = begin[:3]
        x, y, z = slope[3:]
        twist[:3, :3] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
        twist[:3, 3] = middle.inv().apply(slope[:3])
        ahead = pose @ expm(row['horizon_s'] * twist)
        off = flight.position[then] - ahead[:3, 3]
        np.testing.assert_allclose(row['coasting_m'], off, atol=1e-3)
        turn = (Rotation.from_matrix(ahead[:3, :3]).inv() * there).as_rotvec()
        np.testing.assert_allclose(row['coasting_rad'], turn, atol=1e-6)


def root_mean_square(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))


def test_rows_add_up_to_the_summary(studied: ForecastStudy, rows: list[dict[str, Any]]) -> None:
    data = build_report(studied).data
    assert isinstance(data, Mapping)
    assert [one['horizon_s'] for one in data['summary']] == [1.0, 3.0, 8.0]
    assert sum(one['count'] for one in data['summary']) == len(rows) == len(data['rows'])
    for one in data['summary']:
        own = [row for row in rows if row['horizon_s'] == one['horizon_s']]
        assert one['count'] == len(own)
        heading = np.array([row['heading_rad'] for row in own])
        for kind, name in (('vehicle', 'error'), ('coasting', 'coasting')):
            place, turn = (
                np.array([row[f'{name}_{unit}'] for row in own]) for unit in ('m', 'rad')
            )
            along = place[:, 0] * np.cos(heading) + place[:, 1] * np.sin(heading)
            beside = place[:, 1] * np.cos(heading) - place[:, 0] * np.sin(heading)
            assert one[kind] == pytest.approx({
                'position': root_mean_square(np.linalg.norm(place, axis=1)),
                'attitude': root_mean_square(np.linalg.norm(turn, axis=1)),
                'nose': root_mean_square(along),
                'side': root_mean_square(beside),
                'up': root_mean_square(place[:, 2]),
            })  # fmt: skip


def test_forecasts_begin_every_one_and_a_half_seconds(rows: list[dict[str, Any]]) -> None:
    for name in ('A', 'B'):
        starts = sorted({row['start_s'] for row in rows if row['flight'] == name})
        # 37 or 38 periods of 40 ms
        np.testing.assert_allclose(np.diff(starts), 1.5, atol=PERIOD)


def test_a_file_that_knows_the_hidden_drag_forecasts_better(
    hidden_bags: Bags, studied: ForecastStudy, tmp_path: Path
) -> None:
    text = find_file('vehicle', 'gtmab').read_text()
    place = tmp_path / 'draggy.yaml'
    place.write_text(set_yaml_values(text, {'aero.linear_drag.force.value': [0.04, 0.0, 0.0]}))
    true, plain = study_forecasts(str(place), hidden_bags[:2]).scores[-1], studied.scores[-1]
    assert true.errors[COASTING] == plain.errors[COASTING]
    assert true.errors[FILE_MODEL].nose < 0.5 * plain.errors[FILE_MODEL].nose
    assert plain.positions[FILE_MODEL] < 0.5 * plain.positions[COASTING]


def build_study(errors: list[list[float]]) -> ForecastStudy:
    """Return forecasts of one second with given errors; coasting is off by 2 m to the north."""
    table = np.array(errors)[:, None]
    coasting = np.zeros_like(table)
    coasting[..., 1] = 2.0
    starts, headings = 1.5 * np.arange(len(errors)), np.full(len(errors), 0.5 * np.pi)
    return ForecastStudy('mine', ('A',), (
        FlightForecasts(starts, (1.0,), table, coasting, headings, np.abs(table)),
    ))  # fmt: skip


def test_errors_are_split_by_the_heading() -> None:
    """Nose to the north: 3 m to the east are to the right, 4 m to the north ahead."""
    report = build_report(build_study([[3.0, 4.0, 0.0, 0.0, 0.0, 0.1], [np.nan] * 6]))
    assert isinstance(report.data, Mapping)
    (one,) = report.data['summary']
    assert one['count'] == len(report.data['rows']) == 1
    assert one['vehicle'] == pytest.approx(
        {'position': 5.0, 'attitude': 0.1, 'nose': 4.0, 'side': 3.0, 'up': 0.0}
    )
    assert one['coasting']['nose'] == pytest.approx(2.0)
    assert 'forecasts the position to 500 cm, and coasting to 200 cm' in report.headline


def test_what_diverges_is_null_and_said() -> None:
    report = build_report(build_study([[np.inf] * 6, [0.0] * 6]))
    assert isinstance(report.data, Mapping)
    assert report.data['rows'][0]['error_m'] == [None] * 3
    assert report.data['summary'][0]['vehicle']['position'] is None
    assert report.data['summary'][0]['count'] == 2
    assert 'diverged' in report.headline
    assert 'diverged' in render_report(report)


def test_the_command_writes_what_it_prints(
    hidden_bags: Bags, studied: ForecastStudy, tmp_path: Path, call
) -> None:
    words = ('simulate', '--vehicle', 'gtmab', '--commands', *hidden_bags[:2], '--forecasts')
    status, said = call(*words, '--json', '--out', tmp_path / 'out')
    assert status == 0
    printed = json.loads(said.out)
    assert Path(printed.pop('page')).is_file()
    assert printed == json.loads((tmp_path / 'out/forecasts.json').read_text())
    assert printed == build_report(studied).data
    assert re.search(r'ahead +vehicle file +coasting', said.err)


def test_a_bag_that_cannot_be_forecast_is_refused(tmp_path: Path) -> None:
    """No commands, no poses, or four seconds of flight."""
    time = np.arange(0.0, 20.0, 0.01)
    poses = np.column_stack([
        0.5 * time, 0.1 * time**2, 2.0 + 0.0 * time, np.zeros((len(time), 3)), np.ones(len(time)),
    ])  # fmt: skip
    poses[:, :3] += np.random.default_rng(1).normal(0.0, 1e-3, (len(time), 3))
    names = load_vehicle('gtmab').rotor_names
    duties = np.column_stack([0.3 + 0.2 * np.sin(time + k) for k in range(len(names))])
    both = {'ground_truth/odom': (time, poses), 'motors': (time, duties)}
    for topic, text in (('motors', 'no commands'), ('ground_truth/odom', 'pose')):
        kept = {key: value for key, value in both.items() if key != topic}
        write_bag(tmp_path / f'without_{text}', kept, names, {})
        with pytest.raises(BadInput, match=text):
            study_forecasts('gtmab', [tmp_path / f'without_{text}'])
    brief = {key: (time[:400], values[:400]) for key, (_, values) in both.items()}
    write_bag(tmp_path / 'short', brief, names, {})
    with pytest.raises(BadInput, match='s of the flights of --commands are usable'):
        study_forecasts('gtmab', [tmp_path / 'short'])


@pytest.mark.parametrize(
    ('words', 'text'),
    [
        (['--forecasts'], 'add --commands BAG'),
        (['--forecasts', '--commands', 'A', '--seed', '3', '--no-bag'], '--seed and --bag cannot'),
        (['--forecasts', '--commands', 'A', '--begin', '3'], '--begin cannot'),
        (['--forecasts', '--commands', 'none'], "'none' does not exist"),
        (['--commands', 'A', 'B'], 'or add --forecasts'),
    ],
)
def test_requests_without_a_meaning_are_refused(
    words: list[str], text: str, tmp_path: Path, call
) -> None:
    status, said = call('simulate', *words, '--out', tmp_path / 'out')
    assert status == 2
    assert text in said.err
    assert said.err.count('\n') == 1
    assert not (tmp_path / 'out').exists()
