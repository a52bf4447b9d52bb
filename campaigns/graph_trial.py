# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One trial with a graph: a folder and a domain of its own, an outcome, and nothing left."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
import tempfile
import time
from typing import Any, Final, final, Self

from domain import free_domain
from lta_emulation.step_thread import StepThread
import peer as peers
from peer import Peer, put_away

from campaigns import ROOT

SLACK: Final = 1.0  # s beyond what is stated, for a machine with other work
NAP: Final = 0.01  # s between two looks at how late the machine is
READY: Final = {  # who must have said what before anybody may arm a drone of hardware
    'crazyflie_bridge: link': 'connected',
    'teensy_bridge: light board': 'receiving light',
    'estimator: estimate': 'biases are known',
    'demodulator: light': 'beacon found',
    'navigator: mission': 'climb',
}
ROUNDS: Final = 1000  # of three lanterns, half a minute each: more than a day takes


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a flight."""

    # From the fault, or from the request to disarm, to motors that stand [s]
    took: float | None = None
    flew_on: bool = False  # whether it was flying until it was asked to disarm
    phase: str = ''  # in which the fault came
    wrong: str = ''  # what must not be; empty where all is as stated
    # Whether that is a time that was missed or another word that was said, both of which a machine
    # that stands still brings about by itself
    timing: bool = False


@final
class Lateness:
    """
    Sleep again and again, for as long as the context lasts.

    Attributes
    ----------
    most : float
        By how much a sleep was too long at most. [s]

    """

    def __init__(self) -> None:
        self.most = 0.0
        self._thread = StepThread(self._sleep, 'lateness')

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.stop()

    def _sleep(self) -> None:
        began = time.monotonic()
        time.sleep(NAP)
        self.most = max(self.most, time.monotonic() - began - NAP)


def try_flight(fly: Callable[[Path, Peer], Outcome]) -> dict[str, Any]:
    """Return the row of a flight in a folder and a domain of its own; a break is one, too."""
    peers.PATIENCE = 90.0  # s: its nodes start beside those of others
    with (
        tempfile.TemporaryDirectory() as name,
        free_domain() as domain,
        Peer(domain) as peer,
        Lateness() as machine,
    ):
        try:
            outcome = fly(Path(name), peer)
        except Exception as error:
            text = f'{type(error).__name__}: {error}'[:300]
            outcome = Outcome(wrong=text, timing=isinstance(error, AssertionError))
        finally:
            put_away()
    return {**asdict(outcome), 'late': machine.most}


def join_faults(outcome: Outcome, *others: str) -> Outcome:
    """Return an outcome with the first of other faults, which are no matters of time."""
    other = next(filter(None, others), '')
    return outcome if outcome.wrong or not other else replace(outcome, wrong=other)


def write_endless_flight(folder: Path) -> dict[str, object]:
    """
    Write a flight that does not end, and return its parts as arguments of a flight, by name.

    From lantern to lantern and round again, on a battery that does not run out.
    """
    route = ', '.join(('aisle', 'gate', 'dock') * ROUNDS)
    scene = _write_changed('scenarios/warehouse_patrol.yaml', folder, {
        'route: [aisle, gate]': f'route: [{route}]', 'time_limit: 180 s': 'time_limit: 86400 s',
    })  # fmt: skip
    vehicle = _write_changed('vehicles/gtmab.yaml', folder, {'250, unit: mA h': '250, unit: A h'})
    # The strategy says when it has arrived, which a route needs
    return {'scenario': scene, 'vehicle': vehicle, 'strategy': 'homing'}


def _write_changed(name: str, folder: Path, changes: dict[str, str]) -> Path:
    """Write a shipped file with other words into a folder, and return its path."""
    text = (ROOT / 'config' / name).read_text()
    for old, new in changes.items():
        assert text.count(old) == 1, f'{name} no longer says {old!r} once'
        text = text.replace(old, new)
    path = folder / Path(name).name
    path.write_text(text)
    return path
