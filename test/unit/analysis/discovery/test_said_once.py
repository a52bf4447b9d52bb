"""Warnings that are true of many flights."""

from lta_analysis.discovery.said_once import said_once


def test_the_same_of_several_is_said_once_and_the_rest_as_it_was() -> None:
    late = [f'{name} is late, which is odd.' for name in 'ABCDE']
    other = ['B: a gap of 2 s is cut out.', 'F is late.', 'No flight was held out.']
    assert said_once([*late[:2], *other, *late[2:]]) == [
        'A, B, C and 2 more are late, which is odd.',
        *other,
    ]
