"""What the user can mend: one sentence with the fact, the value and the remedy."""

from difflib import get_close_matches


class BadInput(ValueError):
    """
    Input from outside cannot be used.

    The text is the whole message a person sees: one sentence that names the fact, the value
    and what to do about it. Commands print it and exit with status 2. It stays on one line where
    a name or a cell that it quotes does not.
    """

    def __init__(self, text: str) -> None:
        super().__init__(to_one_line(text))


def to_one_line(text: str) -> str:
    """Return a text with a blank for each line break and whatever else cannot be printed."""
    if text.isprintable():
        return text
    return ''.join(part if part.isprintable() else ' ' for part in text)


def strip_control_codes(text: str) -> str:
    """
    Return a text without what commands a terminal; its lines stay.

    Names and notes in the files of others are printed, and an escape sequence among them could
    set a window's title or write over what was said before.
    """
    if text.isprintable():
        return text
    return ''.join(part if part.isprintable() or part in '\t\n\r' else ' ' for part in text)


def unknown_name(kind: str, name: str, names: list[str]) -> BadInput:
    """
    Return the error for a name that is not in a registry or folder.

    Parameters
    ----------
    kind : str
        What the name should have been, for example 'vehicle'.
    name : str
        The name that was given.
    known : list of str
        The names that exist.

    """
    likely = get_close_matches(name, names, 1)
    meant = f" (did you mean '{likely[0]}'?)" if likely else ''
    return BadInput(
        f"Unknown {kind} '{name}'; known: {', '.join(sorted(names)) or 'none'}{meant}."
    )
