"""What a recording says of the clock of its stamps: two that count alike share no clock by it."""

from collections.abc import Mapping
from typing import Final

CLOCK: Final = 'clock'  # in the provenance, where stamps tell no time that another log shares


def have_own_clocks(a: Mapping[str, str], b: Mapping[str, str]) -> bool:
    """
    Tell whether two recordings' stamps are alike by counting, not by a clock they share.

    Parameters
    ----------
    a, b : mapping of str to str
        Their provenance. One source imported twice is one clock.

    """
    sources = a.get('source_sha256'), b.get('source_sha256')
    return CLOCK in a and CLOCK in b and sources[0] != sources[1]
