"""The console of every verb: what it is given it prints as it stands."""

from rich.console import Console


def plain_console(stderr: bool = False) -> Console:
    """
    Return a console to which no name is markup.

    Names in the recordings and files of others may hold what rich takes for a style, and an
    unknown one would end the command.
    """
    return Console(stderr=stderr, markup=False, emoji=False)
