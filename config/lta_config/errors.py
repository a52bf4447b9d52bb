# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Errors that the user can correct: one sentence with the fact, the value and the remedy."""

from difflib import get_close_matches
from typing import Final
from unicodedata import category

# Categories of Unicode: control characters, surrogates, separators of lines and paragraphs
UNWRITABLE: Final = ('Cc', 'Cs', 'Zl', 'Zp')


class BadInput(ValueError):
    """
    External input cannot be used.

    The text is the whole message that the user sees: one sentence with the fact, the value and
    what to do about it. Commands print it and exit with status 2. Line breaks in quoted names are
    replaced.
    """

    def __init__(self, text: str) -> None:
        super().__init__(to_one_line(text))


def to_one_line(text: str) -> str:
    """Return a text without line breaks and other control characters."""
    return text if text.isprintable() else ''.join(map(_make_printable, text))


def strip_control_codes(text: str) -> str:
    """
    Return a text without control characters; line breaks and tabs remain.

    Names and notes from other people's files are printed. An escape sequence in them could set the
    window's title or overwrite earlier output; characters without width or with a direction could
    make a name look like another.
    """
    if text.replace('\n', '').isprintable():
        return text
    return ''.join(part if part in '\t\n' else _make_printable(part) for part in text)


def _make_printable(character: str) -> str:
    """Return a space for white space, and U+FFFD for what else is not printable."""
    if character.isprintable():
        return character
    return ' ' if character.isspace() else '\ufffd'


def check_printable(text: str) -> None:
    """
    Raise BadInput for a name or argument with control characters or bytes that are not UTF-8.

    Python shows such bytes of a path as surrogates. Neither fits into YAML, JSON, pages or bags.
    """
    if any(category(character) in UNWRITABLE for character in text):
        raise BadInput(
            f"'{text}' contains a control character, or bytes that are not UTF-8; rename the file "
            'or correct the argument.'
        )


def unknown_name_error(kind: str, name: str, names: list[str]) -> BadInput:
    """
    Return the error for a name that is not in a registry or folder.

    `kind`: what the name should be, for example 'vehicle'. `name`: the given name. `names`: the
    names that exist.
    """
    likely = get_close_matches(name, names, 1)
    meant = f" (did you mean '{likely[0]}'?)" if likely else ''
    return BadInput(
        f"Unknown {kind} '{name}'; known: {', '.join(sorted(names)) or 'none'}{meant}."
    )


def format_count(count: int, noun: str) -> str:
    """Return a count with its noun in the singular or plural: '1 case', '2 cases'."""
    return f'{count} {noun}{"" if count == 1 else "s"}'
