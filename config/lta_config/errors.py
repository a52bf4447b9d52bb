"""Errors that the user can correct: one sentence with the fact, the value and the remedy."""

from difflib import get_close_matches


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
    """Return a text with a space for each line break or other unprintable character."""
    if text.isprintable():
        return text
    return ''.join(part if part.isprintable() else ' ' for part in text)


def strip_control_codes(text: str) -> str:
    """
    Return a text without control characters; line breaks and tabs remain.

    Names and notes from other people's files are printed. An escape sequence in them could set the
    window's title or overwrite earlier output.
    """
    if text.isprintable():
        return text
    return ''.join(part if part.isprintable() or part in '\t\n\r' else ' ' for part in text)


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
