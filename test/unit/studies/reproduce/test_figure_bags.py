"""Flights behind figures in bags: made of what was flown, and told where they are."""

from pathlib import Path

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_control.gains_file import load_law_gains
from lta_model.scenario import load_scenario
from lta_studies.platforms.run import ABLATION, build_loop, CONTESTANT, PlatformJob
from lta_studies.reproduce.recording import (
    collect_flight_files,
    record_flight,
    relative_bag_path,
    write_yaml,
)
from mcap.reader import make_reader
import pytest


def job(name, kind=CONTESTANT):
    return PlatformJob('platforms', kind, name, 'climb', 1)


@pytest.mark.parametrize(
    'told',
    [job('gtmab'), job('beavis_paper'), job('gtmab_open_loop', ABLATION)],
    ids=lambda j: j.name,
)
def test_the_files_beside_a_bag_are_what_was_flown(told, tmp_path):
    loop = build_loop(told)
    names = {
        k: write_yaml(content, tmp_path / f'{k}.yaml')
        for k, content in collect_flight_files(loop).items()
    }
    assert load_vehicle_file(names['vehicle']) == loop.world.vehicle.file
    assert load_scenario(names['scenario']) == loop.world.scenario
    assert load_law_gains(type(loop.policy.gains), names['gains']) == loop.policy.gains


def test_a_flight_is_recorded_with_its_seed_and_its_duties(tmp_path):
    folder = tmp_path / 'bags' / 'closed_loop' / 'climb' / 'gtmab'
    record_flight(build_loop(job('gtmab')), lambda loop: loop.world.elapsed > 0.5, folder)
    bag = next((folder / 'bag').glob('*.mcap'))
    with bag.open('rb') as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        counts = {
            channel.topic.rpartition('/')[2]: summary.statistics.channel_message_counts.get(
                channel.id, 0
            )
            for channel in summary.channels.values()
        }
        origin = {k: v for each in reader.iter_metadata() for k, v in each.metadata.items()}
    assert counts['motors'] == counts['imu'] > 10
    assert origin['seed'] == '1'
    assert origin['law'] == 'cascade'
    with pytest.raises(BadInput, match='not empty'):
        record_flight(build_loop(job('gtmab')), lambda loop: True, folder)


def test_the_page_comes_to_bags_from_its_own_folder():
    assert relative_bag_path(Path('/anywhere/paper/bags/beavis/turn')) == 'bags/beavis/turn'
