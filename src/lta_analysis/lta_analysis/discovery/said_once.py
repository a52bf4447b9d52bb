"""What is true of many flights, said once."""

from collections.abc import Sequence
from typing import Final

TOLD: Final = 3  # flights that a sentence names; more are counted
IS: Final = ' is '


def said_once(sentences: Sequence[str]) -> list[str]:
    """
    Return sentences of which those that say the same of several flights have become one.

    Parameters
    ----------
    sentences : sequence of str
        'A is late.', 'B is late.'; what does not begin with a name and 'is' stays as it is.

    Returns
    -------
    list of str
        'A, B are late.', each where it was said first.

    """
    same: dict[str, list[str]] = {}
    for sentence in sentences:
        name, verb, rest = sentence.partition(IS)
        single = verb and not set(name) & set(' ,:')
        same.setdefault(rest if single else sentence, []).append(name if single else '')
    out = []
    for rest, names in same.items():
        if not names[0]:
            out.append(rest)
            continue
        more = f' and {len(names) - TOLD} more' if len(names) > TOLD else ''
        verb = ' are ' if len(names) > 1 else IS
        out.append(f'{", ".join(names[:TOLD])}{more}{verb}{rest}')
    return out
