# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What counts as identical, the same or different; and what a replay is started with."""

import math
from pathlib import Path
from types import SimpleNamespace

from lta_bridge.playback.node_selection import list_replayable_roles
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.topics import load_topic_table
from lta_flight.replay.comparison import (
    channel_tolerance,
    compare_topic,
    find_differences,
    find_origin_differences,
    TopicMessages,
)
from lta_flight.replay.decisions import compare_decisions, compute_differences
from lta_flight.replay.node_settings import NODES, parse_settings
from lta_flight.replay.replay_request import (
    build_launch_plan,
    check_request,
    parse_nodes,
    ReplayRequest,
)
from lta_flight.replay.report import build_report
from lta_flight.replay.run import ReplayRun
from lta_flight.replay.verdict import ReplayVerdict
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
import yaml

NAN = math.nan


def heard(keys, texts=None, **numbers):
    return TopicMessages(
        np.array(keys, np.int64),
        {name.replace('__', '.'): np.array(column) for name, column in numbers.items()},
        {name: np.array(column) for name, column in (texts or {}).items()},
    )


def verdict(*found, place=()):
    return ReplayVerdict(tuple(found), tuple(compare_decisions(found)), tuple(place), 0)


def test_bits_decide_and_nothing_is_as_good_as_nothing():
    x = np.array([1.0, NAN, 0.0, np.inf, 1.0, NAN])
    y = np.array([1.0, NAN, -0.0, np.inf, np.nextafter(1.0, 2.0), 0.0])
    assert find_differences(x, y).tolist() == [False, False, True, False, True, True]
    assert find_differences(np.array([2**53, 2**53 + 1]), np.array([2**53, 2**53])).tolist() == [
        False,
        True,
    ]
    assert find_differences(np.array(['a', 'b']), np.array(['a', ''])).tolist() == [False, True]


def test_what_may_differ_between_machines_is_a_share_of_the_largest_value():
    values = np.array([0.1, -40.0, NAN])
    assert channel_tolerance(values, values) == pytest.approx(4e-8)
    single = np.array([0.5, 40.0], np.float32).astype(np.float64)
    assert channel_tolerance(single, single) == pytest.approx(40.0 * 2.0**-23)
    assert channel_tolerance(np.array([NAN]), np.array([NAN])) == 0.0


def test_a_field_that_differs_is_told_with_its_first_and_largest_difference():
    a = heard([10, 20, 30], {'name': ['x', 'y', 'z']}, speed=[1.0, 2.0, 3.0], turns=[1, 2, 3])
    b = heard([10, 20, 40], {'name': ['x', 'w', 'z']}, speed=[1.0, 2.5, 9.0], turns=[1, 2, 9])
    found = compare_topic('odom', a, b, stamped=True)
    assert (found.count, found.differing, found.unmatched) == (2, 1, (1, 1))
    by_path = {each.path: each for each in found.channels}
    assert set(by_path) == {'speed', 'name'}
    speed = by_path['speed']
    assert (speed.count, speed.first, speed.largest) == (1, 1, 0.5)
    assert (speed.recorded, speed.again, speed.close) == (2.0, 2.5, False)
    assert (by_path['name'].recorded, by_path['name'].again) == ('y', 'w')


def test_what_only_one_run_has_differs():
    found = compare_topic('odom', heard([1], x=[1.0]), heard([1], x=[1.0], y=[2.0]), stamped=True)
    assert [(each.path, each.largest) for each in found.channels] == [('y', math.inf)]


def test_without_stamps_the_turn_counts_where_none_is_missing_else_the_log_time():
    a, b = heard([100, 200, 300], data=[0, 0, 1]), heard([101, 201, 301], data=[0, 1, 1])
    assert compare_topic('energy/reserve', a, b, stamped=False).differing == 1
    late = heard([200, 300], data=[0, 1])
    found = compare_topic('energy/reserve', a, late, stamped=False)
    assert (found.count, found.differing, found.unmatched) == (2, 0, (1, 0))


def test_a_last_bit_is_the_same_elsewhere_and_different_here():
    a = heard([1, 2], twist__linear__x=[0.5, 0.25])
    b = heard([1, 2], twist__linear__x=[np.nextafter(0.5, 1.0), 0.25])
    found = compare_topic('setpoint/velocity', a, b, stamped=True)
    assert verdict(found).word == 'different'
    assert verdict(found, place=['commit']).word == 'same'
    far = compare_topic(
        'setpoint/velocity', a, heard([1, 2], twist__linear__x=[0.5 + 1e-8, 0.25]), stamped=True
    )
    assert verdict(far, place=['commit']).word == 'different'
    same = compare_topic('setpoint/velocity', a, a, stamped=True)
    assert verdict(same).word == 'identical'
    assert verdict(same).sentence == (
        'Identical to the last bit: 2 messages (2 of setpoint/velocity)'
    )


def test_a_whole_number_is_never_nearly_the_same():
    found = compare_topic('odom', heard([1], n=[10**12]), heard([1], n=[10**12 + 1]), stamped=True)
    assert not found.is_close
    assert verdict(found, place=['platform']).word == 'different'


def test_a_lamp_that_is_lost_is_a_changed_decision_even_within_the_tolerance():
    """The covariance may be as near as it likes: seen or not is a decision."""
    a = heard([1, 2], **{'pose__covariance[0]': [1e-12, 1e9]})
    b = heard([1, 2], **{'pose__covariance[0]': [-1e-12, 1e9]})
    found = compare_topic('light/estimate', a, b, stamped=True)
    assert found.is_close
    made = verdict(found, place=['platform'])
    assert made.decisions[0].change_count == 1
    assert made.word == 'different'


def test_headings_are_compared_on_the_shorter_side():
    turned = compute_differences(
        np.radians([179.0, 10.0]), np.radians([-179.0, 10.0]), turning=True
    )
    assert np.degrees(turned) == pytest.approx([2.0, 0.0])
    assert compute_differences(
        np.array([NAN, 1.0]), np.array([NAN, NAN]), turning=False
    ).tolist() == [
        0.0,
        math.inf,
    ]


def test_a_heading_is_read_from_its_quaternion():
    half = np.radians(np.array([0.0, 45.0, 85.0]))
    pose = {'pose__orientation__z': np.sin(half), 'pose__orientation__w': np.cos(half)}
    other = {
        'pose__orientation__z': np.sin(half + 0.05),
        'pose__orientation__w': np.cos(half + 0.05),
    }
    found = compare_topic(
        'setpoint/pose', heard([1, 2, 3], **pose), heard([1, 2, 3], **other), True
    )
    (heading,) = compare_decisions([found])
    assert np.degrees(heading.recorded) == pytest.approx([0.0, 90.0, 170.0])
    assert heading.largest_change == pytest.approx(0.1)


def test_only_what_moves_the_last_bit_makes_a_bag_one_from_elsewhere():
    told = {'platform': 'a', 'libraries': 'b', 'commit': 'c', 'created': 'then'}
    assert find_origin_differences(told, {**told, 'created': 'now'}) == []
    assert find_origin_differences({**told, 'commit': 'd'}, told) == ['commit']
    assert find_origin_differences({}, told) == ['platform', 'libraries', 'commit']


def test_settings_are_of_the_type_that_the_node_declares():
    nodes = ('demodulator', 'navigator')
    given = ['demodulator.window=4', 'demodulator.prior.distance=4', 'navigator.altitude=1']
    found = parse_settings(given, nodes)
    assert found == {
        'demodulator': {'window': 4, 'prior.distance': 4.0},
        'navigator': {'altitude': 1.0},
    }
    assert type(found['navigator']['altitude']) is float


def test_nodes_are_those_of_the_graph():
    assert set(NODES) == set(list_replayable_roles(load_topic_table()))
    assert parse_nodes('navigator, demodulator,navigator') == ('navigator', 'demodulator')
    with pytest.raises(BadInput, match="Unknown node 'recorder'; known: controller"):
        parse_nodes('recorder')
    with pytest.raises(BadInput, match='No node to replay was given'):
        parse_nodes(',')


def flight(**told):
    topics = ['photodiodes', 'odom', 'energy/reserve', 'imu']
    message = SimpleNamespace(header=SimpleNamespace(frame_id='lta2/odom'))
    bag = SimpleNamespace(
        iterate_messages=lambda names: iter([(names[0], 0, b'')]), decode=lambda *_: message
    )
    return SimpleNamespace(provenance=told, robot='lta2', topics=topics, bag=bag)


def test_a_replay_starts_the_player_and_the_nodes_with_what_the_bag_carries(tmp_path):
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    gains = find_file('gains', 'gtmab').read_text(encoding='utf-8')
    told = {'vehicle_file': text, 'gains_file': gains, 'set': 'mission.altitude=0.6'}
    settings = {'navigator': {'speed': 0.3}}
    order = ReplayRequest(tmp_path / 'bag', ('navigator', 'controller'), settings)
    plan = build_launch_plan(order, flight(**told), tmp_path)
    by_name = {process.name: process.parameters for process in plan.processes}
    assert list(by_name) == ['player', 'controller', 'navigator']
    assert plan.namespaces == ['lta2']
    player = by_name['player']
    assert player['bag'] == str(tmp_path / 'bag')
    assert player['nodes'] == 'navigator controller'
    assert player['roles'] == 'estimator demodulator energy_monitor'
    assert (player['time'], player['source'], player['robot']) == ('lockstep', 'replay', 'lta2')
    assert player['answers'] == str(tmp_path / 'bag')
    assert by_name['controller']['frame_prefix'] == 'lta2/'  # as that of the recorded frames
    assert (by_name['navigator']['altitude'], by_name['navigator']['speed']) == (0.6, 0.3)
    carried = Path(by_name['controller']['vehicle'])
    assert yaml.safe_load(carried.read_text(encoding='utf-8')) == yaml.safe_load(text)
    assert load_vehicle(str(carried)).rotor_names == load_vehicle('gtmab').rotor_names
    passed = Path(next(p.parameter_file for p in plan.processes if p.name == 'controller'))
    assert yaml.safe_load(passed.read_text(encoding='utf-8')) == yaml.safe_load(gains)


def test_what_is_asked_for_replaces_what_the_bag_carries(tmp_path):
    told = {'vehicle_file': 'none of it is read', 'gains_file': 'neither is this'}
    order = ReplayRequest(tmp_path, ('controller',), vehicle='gtmab', gains='gtmab', rate=2)
    plan = build_launch_plan(order, flight(**told), tmp_path)
    by_name = {process.name: process.parameters for process in plan.processes}
    assert by_name['controller']['vehicle'] == 'gtmab'
    assert (by_name['player']['time'], by_name['player']['rate']) == ('realtime', 2.0)
    assert order.changes == ['vehicle gtmab', 'gains gtmab']
    assert list(tmp_path.glob('*.yaml')) == []


def test_a_node_without_what_it_answers_cannot_be_replayed(tmp_path):
    order = ReplayRequest(tmp_path / 'bag', ('energy_monitor',))
    with pytest.raises(
        BadInput,
        match=r"has no topic 'battery', which the node energy_monitor needs as input; leave",
    ):
        check_request(order, flight())  # nobody can run a vehicle again
    nothing = SimpleNamespace(topics={}, provenance={})
    with pytest.raises(BadInput, match=r'add estimator to --nodes, or leave controller out'):
        check_request(ReplayRequest(tmp_path / 'bag', ('controller',)), nothing)
    both = ReplayRequest(tmp_path / 'bag', ('controller', 'estimator'))
    check_request(both, flight())  # odom comes from the estimator
    with pytest.raises(BadInput, match='Unknown'):
        check_request(
            ReplayRequest(tmp_path, ('navigator', 'demodulator'), strategy='none'), flight()
        )


def test_a_navigator_that_got_goals_cannot_be_replayed_and_other_nodes_can(tmp_path):
    commanded = flight()
    commanded.provenance = {'commanded': 'true'}
    with pytest.raises(BadInput, match=r'a flight by actions, .* leave navigator out of --nodes'):
        check_request(ReplayRequest(tmp_path, ('demodulator', 'navigator')), commanded)
    check_request(ReplayRequest(tmp_path, ('demodulator',)), commanded)


PLAYED = {'outcome': 'played', 'time_s': '2', 'pace': '5', 'messages': '9', 'answers': '2'}


@pytest.mark.parametrize(
    ('standing', 'moved', 'headline', 'status'),
    [
        (PLAYED, 0.0, 'Identical to the last bit: 2 messages (2 of odom).', 0),
        (PLAYED, 0.5, 'Different: 1 of 2 messages and 0 decisions are not as recorded.', 1),
        (
            None,
            0.0,
            'The replay stopped before the end of the recording. Identical to the last bit: 2 '
            'messages (2 of odom).',
            1,
        ),
    ],
)
def test_the_report_of_a_replay_and_its_exit_status(standing, moved, headline, status):
    again = heard([10**9, 2 * 10**9], x=[1.0, 2.0 + moved])
    found = compare_topic('odom', heard([10**9, 2 * 10**9], x=[1.0, 2.0]), again, stamped=True)
    order = ReplayRequest(Path('bag').absolute(), ('controller',))
    played = ReplayRun(Path('out/bag'), standing)
    report = build_report(played, verdict(found), order, {'seed': '3', 'note': 'x'})
    assert (report.headline, report.status) == (headline, status)
    assert report.facts == {'seed': '3'}
    assert report.tiles[1][1:] == ('2', '', f'{int(moved > 0.0)} differ')
    if moved:
        row = ['odom', 'x', '1 of 2', '2.000', '2', '2.5', '0.5']
        assert report.blocks[0].rows == [row]
        assert 'odom: 1 of 2 messages differ, first x at 2.00 s' in report.closing[1]


def test_a_replay_without_a_comparison_reports_how_much_was_played():
    order = ReplayRequest(Path('bag').absolute(), ('controller',))
    report = build_report(ReplayRun(Path('out/bag'), PLAYED), None, order, {})
    assert report.headline.startswith('Replayed 2 s at 5 x real time: 9 messages played')
    assert (report.status, report.data['whole']) == (0, True)
