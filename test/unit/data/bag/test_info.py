# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A bag at a glance."""

from dataclasses import asdict
from io import StringIO

from lta_bag.bag_folder import find_bag
from lta_data.bag import summarize_bag
from lta_data.bag.info import BagInfo, print_bag_info
from rich.console import Console


def test_figures_of_a_flight(flight_bag):
    info = summarize_bag(flight_bag)
    assert [(t.name, t.type, t.count) for t in info.topics] == [
        ('/clock', 'rosgraph_msgs/msg/Clock', 40),
        ('/lta1/energy/reserve', 'std_msgs/msg/Bool', 4),
        ('/lta1/odom', 'nav_msgs/msg/Odometry', 40),
    ]
    assert info.messages == 84
    assert abs(info.duration - 0.39) < 1e-9
    assert abs(info.topics[2].rate - 100.0) < 1e-6
    assert info.start == 1_001_000_000_000
    assert info.complete
    assert info.size == (flight_bag / 'bag_0.mcap').stat().st_size


def test_json_is_the_same_facts(flight_bag):
    found = asdict(summarize_bag(flight_bag))
    assert found['provenance'] == {'scenario': 'lamp', 'seed': '11'}
    assert found['topics'][1] == {
        'name': '/lta1/energy/reserve',
        'type': 'std_msgs/msg/Bool',
        'count': 4,
        'rate': found['topics'][1]['rate'],
    }
    assert abs(found['topics'][1]['rate'] - 3 / 0.39) < 1e-6


def test_table_shows_topics_provenance_and_losses(flight_bag):
    file = flight_bag / 'bag_0.mcap'
    file.write_bytes(file.read_bytes()[:-1])
    text = StringIO()
    print_bag_info(summarize_bag(flight_bag), Console(file=text, width=200))
    lines = text.getvalue().splitlines()
    row = next(line for line in lines if line.startswith('/lta1/odom'))
    assert row.split() == ['/lta1/odom', 'nav_msgs/msg/Odometry', '40', '100.0']
    assert 'seed: 11' in lines
    assert any(line.startswith('The recording was not finished') for line in lines)


def test_a_whole_file_is_only_counted():
    info = BagInfo(
        'b', 1, None, 0.0, 0, ['lta1'], [], {'seed': '3', 'vehicle_file': 'a: 1\nb: 2\n'}, True, []
    )
    text = StringIO()
    print_bag_info(info, Console(file=text, width=200))
    assert text.getvalue().splitlines()[-2:] == [
        'seed: 3',
        'vehicle_file: 2 lines (print them with --json)',
    ]


def test_a_results_folder_holds_its_bag(tmp_path, flight_bag):
    results = tmp_path / 'results'
    results.mkdir()
    assert find_bag(results) == results
    (results / 'bag').mkdir()
    assert find_bag(results) == results / 'bag'
    assert find_bag(flight_bag) == flight_bag


def test_bag_without_messages(record):
    info = summarize_bag(record([]))
    assert (info.messages, info.duration, info.start, info.topics) == (0, 0.0, None, [])
