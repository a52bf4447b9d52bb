"""What a bag says of its origin is enough to make the flight again."""

from pathlib import Path

from lta_bridge import provenance as origin
from lta_bridge.provenance import provenance
from lta_config.errors import BadInput
from lta_config.files import share
import pytest


@pytest.fixture(autouse=True)
def versions(monkeypatch):
    """Stand in for the installed packages, which a unit test does without."""
    monkeypatch.setattr(origin, 'version', lambda name: '0.1.0')


def test_files_go_into_the_bag_whole_and_under_the_names_given(tmp_path: Path):
    gains = tmp_path / 'mine.yaml'
    gains.write_text('/**/controller: {ros__parameters: {gains: {heading_kp: 0.7}}}\n')
    found = provenance('gtmab', 'lamp_room', str(gains), seed='3')
    assert found['gains_file'] == gains.read_text()
    assert found['scenario_file'] == (share() / 'scenarios/lamp_room.yaml').read_text()
    assert found['vehicle_file'] == (share() / 'vehicles/gtmab.yaml').read_text()
    named = [found[key] for key in ('vehicle', 'scenario', 'gains', 'seed')]
    assert named == ['gtmab', 'lamp_room', str(gains), '3']


def test_gains_that_are_not_there_are_one_sentence():
    with pytest.raises(BadInput, match=r'no gains file /nowhere/g\.yaml'):
        provenance('gtmab', 'lamp_room', '/nowhere/g.yaml')
