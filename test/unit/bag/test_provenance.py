# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a bag says of its origin is enough to make the flight again."""

from pathlib import Path
import subprocess

from lta_bag import provenance as origin
from lta_bag.provenance import collect_provenance, extract_robot_origin, merge_provenance
from lta_config.files import share_folder
from lta_config.schema.vehicle_file import load_vehicle_file
import pytest
import yaml


@pytest.fixture(autouse=True)
def versions(monkeypatch):
    """Stand in for the installed packages, which a unit test does without."""
    monkeypatch.setattr(origin, 'version', lambda name: '0.1.0')


def test_files_go_into_the_bag_whole_and_under_the_names_given(tmp_path: Path):
    gains = tmp_path / 'mine.yaml'
    gains.write_text('/**/controller: {ros__parameters: {gains: {heading_kp: 0.7}}}\n')
    found = collect_provenance('gtmab', 'lamp_room', str(gains), seed='3')
    assert found['gains_file'] == gains.read_text()
    assert found['scenario_file'] == (share_folder() / 'scenarios/lamp_room.yaml').read_text()
    assert found['vehicle_file'] == (share_folder() / 'vehicles/gtmab.yaml').read_text()
    named = [found[key] for key in ('vehicle', 'scenario', 'gains', 'seed')]
    assert named == ['gtmab', 'lamp_room', str(gains), '3']


def test_a_vehicle_is_whole_without_the_users_aero_and_cell_files(tmp_path: Path):
    content = yaml.safe_load((share_folder() / 'vehicles/gtmab.yaml').read_text())
    files = {'aero': 'aero/gtmab.aero.yaml', 'cell': 'cells/anysolar.yaml'}
    for name, shipped in files.items():
        (tmp_path / f'{name}.yaml').write_text((share_folder() / shipped).read_text())
    content['aero'] = f'{tmp_path}/aero.yaml'
    content['energy']['array']['cell'] = f'{tmp_path}/cell.yaml'
    vehicle = tmp_path / 'mine.yaml'
    vehicle.write_text(yaml.safe_dump(content))
    flown = load_vehicle_file(str(vehicle))
    text = collect_provenance(str(vehicle), 'lamp_room', 'gtmab')['vehicle_file']
    assert str(tmp_path) not in text
    for name in files:
        (tmp_path / f'{name}.yaml').unlink()
    vehicle.write_text(text)
    again = load_vehicle_file(str(vehicle))
    assert again.aero == flown.aero
    assert again.energy.array.cell_file.name == 'anysolar'


def test_of_several_robots_each_gets_its_own_origin_back():
    shared = {'scenario': 'room', 'scenario_file': 'a: 1', 'commit': 'abc'}
    first = {**shared, 'seed': '1', 'vehicle': 'gtmab', 'created': '10:00'}
    second = {**shared, 'seed': '2', 'vehicle': 'gtmab', 'created': '10:01', 'offset_y': '-2.0'}
    told = merge_provenance({'lta1': first, 'lta2': second})
    assert told == {
        **shared,
        'robots': 'lta1 lta2',
        'vehicle': 'gtmab',
        'created': '10:00',
        'lta1/seed': '1',
        'lta2/seed': '2',
        'lta2/offset_y': '-2.0',
    }
    assert extract_robot_origin(told, 'lta1') == first
    assert extract_robot_origin(told, 'lta2') == {**second, 'created': '10:00'}
    assert extract_robot_origin(first, 'lta1') == extract_robot_origin(first, '') == first


def test_a_commit_is_dirty_by_code_alone(tmp_path: Path, monkeypatch):
    def git(*words: str) -> None:
        told = ('-c', 'user.name=n', '-c', 'user.email=e@e', *words)
        subprocess.run(['git', *told], cwd=tmp_path, check=True, capture_output=True)

    kept = [tmp_path / place for place in ('src/a.py', 'config/b.yaml', 'docs/scores.md')]
    for path in kept:
        path.parent.mkdir()
        path.write_text('old\n')
    monkeypatch.setattr(origin, 'share_folder', lambda: tmp_path / 'config')
    git('init')
    git('add', '.')
    git('commit', '-m', 'begun')
    clean = origin.read_commit()
    assert len(clean) == 40
    kept[2].write_text('new\n')
    (tmp_path / 'src/untracked.txt').write_text('new\n')
    assert origin.read_commit() == clean
    for path in kept[:2]:
        path.write_text('new\n')
        assert origin.read_commit() == f'{clean}-dirty'
        path.write_text('old\n')
    assert origin.read_commit() == clean
    monkeypatch.setattr(origin, 'share_folder', lambda: tmp_path / 'nowhere')
    assert origin.read_commit() == 'unknown'
