"""Determine whether the stamps of two recordings come from a shared clock."""

from collections.abc import Mapping
from typing import Final

CLOCK: Final = 'clock'  # provenance key of logs whose stamps share no clock with others


def have_separate_clocks(a: Mapping[str, str], b: Mapping[str, str]) -> bool:
    """
    Return whether two recordings have separate clocks, so that equal stamps mean nothing.

    One source imported twice counts as one clock.
    """
    sources = a.get('source_sha256'), b.get('source_sha256')
    return CLOCK in a and CLOCK in b and sources[0] != sources[1]
