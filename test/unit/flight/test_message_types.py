"""Bags with the messages of lta_msgs and with standard ones: one flight, read alike."""

import json
from pathlib import Path
import shutil

from lta_bridge.bag import BagWriter
from lta_config import topics
from lta_config.message_files import list_message_files, read_field_units
from lta_config.topics import load_topic_table
from lta_data.bag import open_flight, read_bag
from lta_data.bag.channels import read_all_channels
from lta_data.bag.recording import open_recording
from lta_flight.flight_run import ROBOT
from lta_flight.flight_spec import build_loop, load_spec
from lta_flight.messages import LoopRecorder
import numpy as np
import pytest

TABLE = load_topic_table()
TYPED = [name for name, topic in TABLE.topics.items() if topic.standard_type]
STORED = Path(__file__).parents[2] / 'replay' / 'lamp.mcap'  # recorded before there was lta_msgs
STEPS = 250


@pytest.fixture(scope='module')
def bags(tmp_path_factory):
    """Return the bags of one flight by the set of message types."""
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        for name in topics.MESSAGE_SETS:
            if name == 'typed' and not topics.is_lta_msgs_built():
                continue
            patch.setenv(topics.MESSAGES, name)
            topics.uses_typed_messages.cache_clear()
            found[name] = tmp_path_factory.mktemp(name) / 'bag'
            loop = build_loop(load_spec('gtmab', 'lamp_room', 'bag', ''), 3)
            with BagWriter(found[name], {'seed': '3', 'vehicle': 'gtmab'}) as writer:
                recorder = LoopRecorder(writer, loop, TABLE, ROBOT)
                for _ in zip(range(STEPS), loop.iterate_steps(), strict=False):
                    recorder.record_step()
    topics.uses_typed_messages.cache_clear()
    return found


@pytest.fixture(params=[*topics.MESSAGE_SETS, 'stored'])
def bag(request, bags):
    """Return a bag with either set of types, and one that was recorded with standard types."""
    if request.param == 'stored':
        return STORED
    if request.param not in bags:
        pytest.skip('lta_msgs was not built: this machine lacks a compiler')
    return bags[request.param]


@pytest.fixture
def both(bags):
    if len(bags) < 2:
        pytest.skip('lta_msgs was not built: this machine lacks a compiler')
    return bags


def test_only_the_types_of_their_topics_differ(both):
    typed, standard = (read_bag(both[name]) for name in topics.MESSAGE_SETS)
    for name, topic in TABLE.topics.items():
        if not topic.recorded or not topic.repeatable:
            continue
        full = topics.robot_topic(ROBOT, name)
        assert typed.topics[full].type_name == topic.declared_type
        assert standard.topics[full].type_name == topic.common_type
        one, two = (list(each.iterate_messages([full])) for each in (typed, standard))
        assert [log_time for _, log_time, _ in one] == [log_time for _, log_time, _ in two]
        assert (one == two) == (name not in TYPED), name


def test_channels_have_the_same_names_units_and_numbers(both):
    one, two = (read_all_channels(open_flight(both[name])) for name in topics.MESSAGE_SETS)
    assert one.remarks == two.remarks == []
    assert set(one.channels) == set(two.channels)
    assert {'motors/effort.up_left', 'light/peaks/snr[7]', 'photodiodes/mean[0]'} <= set(
        one.channels
    )
    assert one.channels['energy/status/power_in'].unit == 'W'
    for name, channel in one.channels.items():
        other = two.channels[name]
        assert channel.unit == other.unit, name
        # A DiagnosticArray has nine digits
        tolerance = 1e-8 if channel.topic == 'energy/status' else 0.0
        np.testing.assert_allclose(channel.values, other.values, rtol=tolerance, err_msg=name)


def test_notebooks_read_both_alike(both):
    one, two = (open_recording(both[name]) for name in topics.MESSAGE_SETS)
    assert one['motors'].columns == two['motors'].columns
    np.testing.assert_array_equal(one['motors'].array('effort'), two['motors'].array('effort'))
    assert one['motors'].units == two['motors'].units
    samples = one['photodiodes'].samples
    assert samples.shape[1:] == (1000, 8)
    np.testing.assert_array_equal(samples, two['photodiodes'].samples)
    assert one['light/peaks'].units == two['light/peaks'].units
    for name in ('x', 'amplitude', 'snr', 'frequency'):
        np.testing.assert_array_equal(
            one['light/peaks'].array(name), two['light/peaks'].array(name)
        )


@pytest.mark.filterwarnings('ignore:Gimbal lock')  # of the downward range_link in /tf
def test_exported_files_are_alike(call, both, tmp_path):
    for name in topics.MESSAGE_SETS:
        words = ('--format', 'csv', '--out', tmp_path / name)
        assert call('bag', 'export', both[name], *words)[0] == 0
    one, two = (
        {path.name: path.read_text() for path in (tmp_path / name).glob('*.csv')}
        for name in topics.MESSAGE_SETS
    )
    assert {'motors.csv', 'photodiodes.csv', 'light_peaks.csv', 'energy_status.csv'} <= set(one)
    assert [name for name in one if one[name] != two[name]] == ['energy_status.csv']
    heads = [each['energy_status.csv'].splitlines()[0] for each in (one, two)]
    assert heads[0] == heads[1]


@pytest.mark.filterwarnings('ignore:Gimbal lock')
def test_every_command_reads_a_bag_of_either_kind(call, bag, tmp_path):
    for words in (
        ('bag', 'info', bag, '--json'),
        ('bag', 'check', bag, '--json'),
        ('bag', 'plot', bag, 'light/peaks/snr*', 'energy/status/power_out', 'photodiodes/mean*'),
        ('bag', 'export', bag, '--format', 'parquet', '--out', tmp_path / 'export'),
        ('compare', bag, bag, '--json', '--out', tmp_path / 'compare'),
        ('report', bag, '--out', tmp_path / 'page'),
    ):
        status, said = call(*words)
        # 1: the check has findings, as of a flight of seconds
        assert status == 0 or (words[1], status) == ('check', 1), (words, said.err)
        assert not said.err or 'Traceback' not in said.err
    found = json.loads(call('compare', bag, bag, '--json', '--out', tmp_path / 'again')[1].out)
    assert found['verdict'] == 'identical'


def test_a_damaged_bag_of_either_kind_is_recovered(call, bag, tmp_path):
    file = bag if bag.is_file() else next(bag.glob('*.mcap'))
    cut = tmp_path / 'cut.mcap'
    shutil.copyfile(file, cut)
    with cut.open('r+b') as damaged:
        damaged.truncate(file.stat().st_size - 100)  # without the footer
    status, said = call('bag', 'recover', cut, '--out', tmp_path / 'whole')
    assert status == 0, said.err
    whole = read_bag(tmp_path / 'whole')
    original = read_bag(bag)
    for name, topic in whole.topics.items():
        assert topic.type_name == original.topics[name].type_name


def test_the_energy_balance_of_another_array_stays_as_it_is(record, types):
    status = types['diagnostic_msgs/msg/DiagnosticStatus']
    time = types['builtin_interfaces/msg/Time'](1, 0)
    message = types['diagnostic_msgs/msg/DiagnosticArray'](
        types['std_msgs/msg/Header'](time, ''), [status(1, 'other', 'fine', '', [])]
    )
    bag = record([('/r/energy/status', 'diagnostic_msgs/msg/DiagnosticArray', message, 5)])
    series = open_flight(bag).read_series('energy/status')
    assert series.numbers['status[0].level'].tolist() == [1]


def test_every_number_of_lta_msgs_has_its_unit_in_a_comment():
    units = read_field_units()
    assert len(units) == len(list_message_files()) == 5
    numbers = {
        (name, line.split()[1])
        for name, path in list_message_files().items()
        for line in path.read_text(encoding='utf-8').splitlines()
        if line.startswith(('float', 'uint16['))
    }
    assert len(numbers) > 25
    assert {(name, field) for name, of in units.items() for field in of} >= numbers
    assert units['lta_msgs/msg/EnergyStatus']['capacity'] == 'C'
