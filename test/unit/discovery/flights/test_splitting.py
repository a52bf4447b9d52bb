# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Bags, which of them teach, confirm and are held out, and what is said of several."""

from dataclasses import replace
import shutil

from lta_config.errors import BadInput
from lta_discovery.flights.bags import (
    assign_roles,
    FLIGHT_ROLES,
    read_bags,
    restrict_to_interval,
)
from lta_discovery.flights.measured_flight import (
    FlightStreams,
    MeasuredFlight,
    resample_flight,
    Stream,
)
from lta_discovery.flights.sentence_merger import merge_sentences
import numpy as np
import pytest

RNG = np.random.default_rng(3)


@pytest.fixture(scope='module')
def flight() -> MeasuredFlight:
    """A minute at one place."""
    time = np.arange(0.0, 62.0, 0.02)
    pose = np.column_stack([1e-3 * RNG.standard_normal((len(time), 6)), np.ones(len(time))])
    return resample_flight(FlightStreams(Stream(time, pose), Stream(time[:1], np.zeros((1, 4)))))


def test_a_part_is_of_the_usable_points_and_nothing_else_changes(flight: MeasuredFlight) -> None:
    first, second = restrict_to_interval(flight, 0.0, 0.4), restrict_to_interval(flight, 0.4, 1.0)
    whole = flight.usable.sum()
    assert first.usable.sum() == pytest.approx(0.4 * whole, abs=1)
    assert not (first.usable & second.usable).any()
    np.testing.assert_array_equal(first.usable | second.usable, flight.usable)
    assert flight.time[first.usable].max() < flight.time[second.usable].min()
    assert first.commands is flight.commands
    np.testing.assert_array_equal(first.position, flight.position)


def test_one_flight_is_split_in_time_and_a_warning_says_so(flight: MeasuredFlight) -> None:
    found, warnings = assign_roles([('A', 'train', flight)])
    assert [role for _, role, _ in found] == list(FLIGHT_ROLES)
    shares = [each.usable.sum() / flight.usable.sum() for _, _, each in found]
    np.testing.assert_allclose(shares, [0.4, 0.3, 0.3], atol=2e-3)
    assert 'weaker' in warnings[0]


def test_training_flights_are_divided_where_nothing_confirms(flight: MeasuredFlight) -> None:
    flights = [(name, 'train', flight) for name in 'ABC'] + [('H', 'holdout', flight)]
    found, warnings = assign_roles(flights)
    assert {name: role for name, role, _ in found} == {
        'A': 'train', 'B': 'train', 'C': 'confirm', 'H': 'holdout',
    }  # fmt: skip
    assert len(warnings) == 1


def test_one_training_flight_beside_one_held_out_is_split_in_two(flight: MeasuredFlight) -> None:
    found, warnings = assign_roles([('A', 'train', flight), ('H', 'holdout', flight)])
    assert [(name, role) for name, role, _ in found] == [
        ('A', 'train'), ('A', 'confirm'), ('H', 'holdout'),
    ]  # fmt: skip
    assert found[0][2].usable.sum() == pytest.approx(0.6 * flight.usable.sum(), abs=1)
    assert 'weaker' in warnings[0]


def test_what_is_given_stays_and_nothing_to_learn_from_is_refused(flight: MeasuredFlight) -> None:
    flights = [('A', 'train', flight), ('B', 'confirm', flight)]
    assert assign_roles(flights) == (flights, [])
    with pytest.raises(BadInput, match='no training flight'):
        assign_roles([('B', 'confirm', flight)])


def _usable(flight: MeasuredFlight, count: int) -> MeasuredFlight:
    """Return the flight with `count` usable points: 100, 103, 106, ..."""
    usable = np.zeros(len(flight.usable), dtype=bool)
    usable[100 : 100 + 3 * count : 3] = True
    return replace(flight, usable=usable)


def test_ten_usable_points_make_three_parts_of_four_three_and_three(
    flight: MeasuredFlight,
) -> None:
    """The parts end at 40, 70 and 100 % of the points; a point at an end belongs to that part."""
    found, _ = assign_roles([('A', 'train', _usable(flight, 10))])
    where = [np.flatnonzero(each.usable).tolist() for _, _, each in found]
    assert where == [[100, 103, 106, 109], [112, 115, 118], [121, 124, 127]]


@pytest.mark.parametrize(('count', 'teach'), [(2, 1), (3, 2), (4, 2), (5, 3)])
def test_of_an_odd_number_of_flights_one_more_trains_than_confirms(
    flight: MeasuredFlight, count: int, teach: int
) -> None:
    found, _ = assign_roles([(f'F{k}', 'train', flight) for k in range(count)])
    assert [role for _, role, _ in found] == ['train'] * teach + ['confirm'] * (count - teach)
    assert [name for name, _, _ in found] == [f'F{k}' for k in range(count)]


def test_bags_keep_their_names_roles_and_order(hidden_bags, tmp_path):
    a, b, c = hidden_bags
    results = tmp_path / 'flown'
    shutil.copytree(c, results / 'bag')  # as the results folder of a flight has it
    again = tmp_path / 'A'
    shutil.copytree(b, again)
    told = []
    found = read_bags({'holdout': [results], 'train': [a, again]}, tell=told.append)
    assert [(one.name, one.role) for one in found] == [
        ('A', 'train'), ('A_2', 'train'), ('flown', 'holdout'),
    ]  # fmt: skip
    assert told == ['A', 'A_2', 'flown']
    assert {one.vehicle for one in found} == {'gtmab'}
    assert found[0].rotor_names == ('forward_left', 'forward_right', 'up_left', 'up_right')
    assert found[0].recording.is_simulated


@pytest.mark.parametrize('role', ['train', 'confirm'])
def test_a_bag_has_one_role(hidden_bags, role):
    a = hidden_bags[0]
    (file,) = a.glob('*.mcap')  # the same in other words
    with pytest.raises(BadInput, match='is given twice'):
        read_bags({'train': [a, *([file] if role == 'train' else [])],
                   **({role: [file]} if role != 'train' else {})})  # fmt: skip


def test_the_same_of_several_is_said_once_and_the_rest_as_it_was() -> None:
    late = [f'{name} is late, which is odd.' for name in 'ABCDE']
    other = ['B: a gap of 2 s is cut out.', 'F is late.', 'No flight was held out.']
    assert merge_sentences([*late[:2], *other, *late[2:]]) == [
        'A, B, C and 2 more are late, which is odd.',
        *other,
    ]


def test_what_differs_in_numbers_alone_is_a_range() -> None:
    said = [
        'data_1: 4 % is lost in 2 gaps.',
        'data_2: 12.5 % is lost in 2 gaps.',
        'data_3: the clock drifts.',
        'data_4: 9 % is lost in 2 gaps.',
    ]
    assert merge_sentences(said, 28) == [
        'In 3 of 28 flights (data_1, data_2, data_4): 4 to 12.5 % is lost in 2 gaps.',
        'data_3: the clock drifts.',
    ]
    odd = ['A: 3 are odd.', 'B: 3 are odd.']
    assert merge_sentences(odd, 2) == ['In 2 of 2 flights (A, B): 3 are odd.']
