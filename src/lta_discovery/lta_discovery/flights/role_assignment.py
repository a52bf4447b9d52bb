# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Assign roles to flights: training, confirming, held out."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.flights.bags import FLIGHT_ROLES
from lta_discovery.flights.measured_flight import MeasuredFlight
import numpy as np

Role = tuple[str, str, MeasuredFlight]

ROLE_ENDS: Final = (0.4, 0.7)  # of the usable time: ends of the training and the confirming part
TRAINING_END: Final = 0.6  # the same, where there is a held-out flight already


def restrict_to_interval(flight: MeasuredFlight, begin: float, end: float) -> MeasuredFlight:
    """
    Return a flight of which only a part is usable.

    The whole flight is still replayed, because lag, gas and battery have memory.

    `begin`, `end`: of the usable points, 0 to 1.
    """
    # Share of the usable time up to each point
    count = np.cumsum(flight.usable) / max(1, int(flight.usable.sum()))
    return replace(flight, usable=flight.usable & (count > begin) & (count <= end))


def assign_roles(flights: Sequence[Role]) -> tuple[list[Role], list[str]]:
    """
    Complete the roles of flights, so that some train and some confirm.

    Returns
    -------
    list of (name, role, MeasuredFlight), list of str
        The same flights where some confirm; otherwise training flights split in two (a single one
        in time), or one flight alone split in three. Then warnings about the split.

    Raises
    ------
    BadInput
        If there is no training flight.

    """
    train = [flight for flight in flights if flight[1] == 'train']
    rest = [flight for flight in flights if flight[1] != 'train']
    if not train:
        raise BadInput('There is no training flight; name at least one with --train.')
    if any(role == 'confirm' for _, role, _ in rest):
        return list(flights), []
    if len(train) > 1:
        # With an odd number, training gets the extra flight.
        half = (len(train) + 1) // 2
        moved = [(name, 'confirm', flight) for name, _, flight in train[half:]]
        remark = 'No flight is given with --confirm, so half of the training flights confirm'
        return [*train[:half], *moved, *rest], [f'{remark} the other half.']
    name, _, flight = train[0]
    if rest:
        parts = [
            (name, 'train', restrict_to_interval(flight, 0.0, TRAINING_END)),
            (name, 'confirm', restrict_to_interval(flight, TRAINING_END, 1)),
        ]
        remark = 'No flight is given with --confirm: the last part of the training flight confirms'
        return [*parts, *rest], [f'{remark} the effects, which is weaker than another flight.']
    first, second = ROLE_ENDS
    edges = zip(FLIGHT_ROLES, (0.0, first, second), (first, second, 1.0), strict=True)
    remark = 'A single flight is split into a training, a confirming and a held-out part, which'
    return [(name, role, restrict_to_interval(flight, a, b)) for role, a, b in edges], [
        f'{remark} gives weaker evidence than three flights.'
    ]
