"""One trial of a campaign: a folder and a domain of its own, an outcome, and nothing left."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
import tempfile
from typing import TypeVar

import add_paths  # noqa: F401
from domain import free_domain
from machine import Lateness
import peer as peers
from peer import Peer, put_away

peers.PATIENCE = 90.0  # s: a flight's nodes start beside those of others
Found = TypeVar('Found', bound='Outcome')


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a flight."""

    # From the fault, or from the request to disarm, to motors that stand [s]
    took: float | None = None
    stated: float | None = None
    flew_on: bool = False  # whether it was flying until it was asked to disarm
    phase: str = ''  # in which it struck
    wrong: str = ''  # what must not be; empty where all is as stated
    # Whether that is a time that was missed or another word that was said, both of which a machine
    # that stands still brings about by itself
    timing: bool = False
    late: float = 0.0  # by how much the machine woke a sleeper too late at most [s]


def tried(fly: Callable[[Path, Peer], Found], broken: type[Found]) -> Found:
    """
    Return the outcome of a trial in a folder and a domain of its own; a break is one, too.

    `fly`: the trial, in a folder, with a peer in the domain. `broken`: what the outcome of a trial
    that broke is.
    """
    with tempfile.TemporaryDirectory() as name, free_domain() as domain, Peer(domain) as peer:
        with Lateness() as machine:
            try:
                found = fly(Path(name), peer)
            except Exception as error:
                text = f'{type(error).__name__}: {error}'[:300]
                found = broken(wrong=text, timing=isinstance(error, AssertionError))
            finally:
                put_away()
        return replace(found, late=machine.most)
