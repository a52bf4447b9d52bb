"""Warnings that are true of many flights."""

from lta_discovery.flights.sentence_merger import merge_sentences


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


def test_the_number_of_flights_is_given_if_there_is_more_than_one() -> None:
    odd = ['A: 3 are odd.', 'B: 3 are odd.']
    assert merge_sentences(odd, 2) == ['In 2 of 2 flights (A, B): 3 are odd.']
    assert merge_sentences(odd, 1) == merge_sentences(odd) == ['A, B: 3 are odd.']


def test_only_separate_numbers_after_a_colon_become_ranges() -> None:
    """Sentences that differ in digits within a word, or have 'is' for the colon, stay apart."""
    said = ['A: lost_3 misses 1.5 s.', 'B: lost_3 misses 0.5 s.', 'C: lost_4 misses 1 s.']
    assert merge_sentences(said, 3) == [
        'In 2 of 3 flights (A, B): lost_3 misses 0.5 to 1.5 s.', 'C: lost_4 misses 1 s.',
    ]  # fmt: skip
    assert merge_sentences(['A is 1 s late.', 'B is 2 s late.']) == [
        'A is 1 s late.',
        'B is 2 s late.',
    ]


def test_a_sentence_that_begins_with_no_name_is_only_deduplicated() -> None:
    said = ['The flight, A: is odd.', 'The other flight is odd.', 'A 1: 2 are odd.']
    assert merge_sentences(said * 2, 2) == said
