# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hashes of what `lta simulate` records: every vehicle in every scenario by every strategy."""

from collections.abc import Iterator
import hashlib
from itertools import product
from typing import Any

from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
from lta_config.topics import load_topic_table
from lta_control.strategies import STRATEGIES
from lta_flight.flight_run import SIMULATED_ROBOT
from lta_flight.flight_spec import build_loop, load_spec
from lta_flight.messages import LoopRecorder

SEED = 5
STEPS = 1500  # of 10 ms: longer than any start, and most flights turn, climb and read the lamp


class Hash:
    """Stand in for a `BagWriter`: hash each topic's messages instead of writing them."""

    def __init__(self) -> None:
        self._sum = hashlib.sha256()

    def add_topic(self, name: str, type_name: str, qos: Any) -> None:
        """Take a topic as a bag does."""
        self._sum.update(f'{name} {type_name} {qos}\n'.encode())

    def write(self, name: str, data: bytes, log_time_ns: int, *_more: Any) -> None:
        """Take a message as a bag does."""
        self._sum.update(f'{name} {log_time_ns} {len(data)}\n'.encode())
        self._sum.update(data)

    def __str__(self) -> str:
        """Return the first 64 bits: enough to tell 308 flights from any others."""
        return self._sum.hexdigest()[:16]


def list_flights() -> Iterator[tuple[str, str, str]]:
    """Yield vehicle, scenario and strategy of every flight."""
    yield from product(list_shipped_names('vehicles'), list_shipped_names('scenarios'), STRATEGIES)


def simulate_flight(vehicle: str, scenario: str, strategy: str) -> dict[str, str]:
    """Return the hash of one flight, or that it was refused."""
    name = f'{vehicle} {scenario} {strategy}'
    try:
        loop = build_loop(load_spec(vehicle, scenario, strategy, ''), SEED)
    except BadInput:
        return {name: 'refused'}
    hashed = Hash()
    recorder = LoopRecorder(hashed, loop, load_topic_table(), SIMULATED_ROBOT)
    for _, _outcome in zip(range(STEPS), loop.iterate_steps(), strict=False):
        recorder.record_step()
    return {name: f'{hashed} {loop.world.outcome.name.lower()}'}
