"""Warnings that are true of many flights."""

from lta_analysis.discovery.flights.said_once import said_once


def test_the_same_of_several_is_said_once_and_the_rest_as_it_was() -> None:
    late = [f'{name} is late, which is odd.' for name in 'ABCDE']
    other = ['B: a gap of 2 s is cut out.', 'F is late.', 'No flight was held out.']
    assert said_once([*late[:2], *other, *late[2:]]) == [
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
    assert said_once(said, 28) == [
        'In 3 of 28 flights (data_1, data_2, data_4): 4 to 12.5 % is lost in 2 gaps.',
        'data_3: the clock drifts.',
    ]


def test_one_flight_twice_is_one_flight() -> None:
    assert said_once(['A: 2 s are odd.', 'A: 3 s are odd.'], 9) == ['A: 2 to 3 s are odd.']
    assert said_once(['A is late.', 'A is late.'], 9) == ['A is late.']
