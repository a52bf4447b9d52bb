# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Merge equal remarks about several flights into one sentence."""

from collections.abc import Sequence
import re
from typing import Final

TOLD: Final = 3  # most flights that a sentence names; more are counted
IS: Final = ' is '
OF: Final = ': '
# Integers and decimals, but not digits inside of names
NUMBER_IN_TEXT: Final = re.compile(r'(?<![\w.])\d+(?:\.\d+)?')


def merge_sentences(sentences: Sequence[str], flights: int = 0) -> list[str]:
    """
    Merge sentences that state the same of several flights.

    Parameters
    ----------
    sentences : sequence of str
        'A is late.', 'B: 3 readings are odd.', 'C: 5 readings are odd.'; sentences without a name
        stay as they are.
    flights : int
        Number of flights; 0 to omit it.

    Returns
    -------
    list of str
        'A is late.', 'In 2 of 9 flights (B, C): 3 to 5 readings are odd.', in the order of first
        occurrence.

    """
    same: dict[str, list[tuple[str, str]]] = {}
    for sentence in sentences:
        name, rest = _split_sentence(sentence)
        # Sentences that differ only in numbers have one key.
        key = NUMBER_IN_TEXT.sub('#', rest) if rest.startswith(OF) else rest
        same.setdefault(key if name else sentence, []).append((name, rest or sentence))
    return [_merge_group(pairs, flights) for pairs in same.values()]


def _split_sentence(sentence: str) -> tuple[str, str]:
    """Split a sentence into its flight's name and the rest; '', '' if it has no name."""
    name, verb, rest = sentence.partition(OF)
    if verb and not set(name) & set(' ,:'):
        return name, f'{OF}{rest}'
    name, verb, rest = sentence.partition(IS)
    if verb and not set(name) & set(' ,:'):
        return name, f'{IS}{rest}'
    return '', ''


def _merge_group(sentences: Sequence[tuple[str, str]], flights: int) -> str:
    """Merge equal sentences of several flights."""
    # Names without repetitions, in the order of occurrence
    names, rests = (
        list(dict.fromkeys(name for name, _ in sentences)),
        [rest for _, rest in sentences],
    )
    if not names[0]:
        return rests[0]
    if len(names) == 1 and (len(sentences) == 1 or rests[0].startswith(IS)):
        return f'{names[0]}{rests[0]}'
    more = f' and {len(names) - TOLD} more' if len(names) > TOLD else ''
    listed = f'{", ".join(names[:TOLD])}{more}'
    if rests[0].startswith(IS):
        return f'{listed} are {rests[0].removeprefix(IS)}'
    where = f'In {len(names)} of {flights} flights ({listed})' if flights > 1 else listed
    return f'{where if len(names) > 1 else names[0]}{_merge_numbers(rests)}'


def _merge_numbers(rests: Sequence[str]) -> str:
    """Merge sentences that differ only in numbers, giving these as ranges."""
    several = iter(zip(*(NUMBER_IN_TEXT.findall(rest) for rest in rests), strict=True))

    def format_range(_: re.Match[str]) -> str:
        numbers = next(several)
        low, high = min(numbers, key=float), max(numbers, key=float)
        return low if low == high else f'{low} to {high}'

    return NUMBER_IN_TEXT.sub(format_range, rests[0])
