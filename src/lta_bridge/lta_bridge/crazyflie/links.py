"""
Select the link to a Crazyflie by the scheme of its URI.

To add a link, write a module that implements `link.py` and add its name to `LINK_MODULES`. It
defines `SCHEMES`, the URIs that it serves, and `LINK`, its class.
"""

from collections.abc import Callable, Sequence
from importlib import import_module
import re
from typing import Final, NamedTuple

from lta_bridge.crazyflie.link import CrazyflieLink
from lta_bridge.crazyflie.log_table import LogBlock
from lta_config.errors import BadInput

LINK_MODULES: Final = (  # module names
    'cflib_link',
)


class LinkScheme(NamedTuple):
    """Link of one URI scheme."""

    rest: str  # regular expression of the part after ://
    # `link(uri, blocks, clock)` returns a closed link; raises `BadInput` if the link's library is
    # not installed
    link: Callable[[str, Sequence[LogBlock], Callable[[], int]], CrazyflieLink]


LINKS: Final[dict[str, LinkScheme]] = {
    scheme: LinkScheme(rest, made.LINK)
    for made in (import_module(f'{__package__}.{file}') for file in LINK_MODULES)
    for scheme, rest in made.SCHEMES.items()
}


def create_link(uri: str, blocks: Sequence[LogBlock], clock: Callable[[], int]) -> CrazyflieLink:
    """
    Create a link to a Crazyflie, not yet open.

    `clock` returns the graph time. [ns]

    Raises
    ------
    BadInput
        If the URI is invalid, or a library is not installed.

    """
    check_uri(uri)
    return LINKS[uri.partition('://')[0]].link(uri, blocks, clock)


def check_uri(uri: str) -> None:
    """Raise `BadInput` for a URI that no link understands."""
    scheme, _, rest = uri.partition('://')
    if scheme not in LINKS or not re.fullmatch(LINKS[scheme].rest, rest):
        raise BadInput(
            f"'{uri}' is not a valid Crazyflie URI; give one such as radio://0/80/2M/E7E7E7E7E7, "
            'usb://0 or udp://127.0.0.1:19850.'
        )
