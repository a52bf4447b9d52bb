"""
The links to a Crazyflie, by the scheme of its URI.

A link is one file that follows `link.py`, and one line in `FILES`: its `SCHEMES` say which URIs
are its own, its `LINK` is the class.
"""

from collections.abc import Callable, Sequence
from importlib import import_module
import re
from typing import Final, NamedTuple

from lta_bridge.crazyflie.link import CrazyflieLink
from lta_bridge.crazyflie.log_table import LogBlock
from lta_config.errors import BadInput

FILES: Final = (  # each is the file of this name
    'cflib_link',
)


class LinkScheme(NamedTuple):
    """
    How the URIs of one scheme are used.

    Attributes
    ----------
    rest : str
        What comes behind ://, as a regular expression.
    link : callable
        `link(uri, blocks, clock) -> Link`, closed; `BadInput` where it cannot be had here.

    """

    rest: str
    link: Callable[[str, Sequence[LogBlock], Callable[[], int]], CrazyflieLink]


LINKS: Final[dict[str, LinkScheme]] = {
    scheme: LinkScheme(rest, made.LINK)
    for made in (import_module(f'{__package__}.{file}') for file in FILES)
    for scheme, rest in made.SCHEMES.items()
}


def create_link(uri: str, blocks: Sequence[LogBlock], clock: Callable[[], int]) -> CrazyflieLink:
    """
    Return the link to a Crazyflie, closed.

    Parameters
    ----------
    uri : str
        Where it is.
    blocks : sequence of Block
        What to log.
    clock : callable
        Graph time. [ns]

    Raises
    ------
    BadInput
        If the URI names no Crazyflie, or what its link needs is not installed.

    """
    scheme, _, rest = uri.partition('://')
    if scheme not in LINKS or not re.fullmatch(LINKS[scheme].rest, rest):
        raise BadInput(
            f"The URI '{uri}' names no Crazyflie; give one such as radio://0/80/2M/E7E7E7E7E7, "
            'usb://0 or udp://127.0.0.1:19850.'
        )
    return LINKS[scheme].link(uri, blocks, clock)
