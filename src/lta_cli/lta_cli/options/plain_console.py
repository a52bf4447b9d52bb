"""Create the console on which all verbs print."""

from rich.console import Console


def plain_console(stderr: bool = False) -> Console:
    """
    Return a console that does not interpret markup.

    Names in recordings and files may contain text that rich takes for a style, and an unknown
    style raises an error.
    """
    return Console(stderr=stderr, markup=False, emoji=False)
