# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The monitor over cells of unknown charge that feed flights, through the simulator's meters.

16 cells, and 50 by `make test-long`.

The cells differ from their file by the tolerances in `metered`. Readings come once a second here,
which leaves the filter less to work with than the ten of the graph; an earlier campaign
measures all of it at ten.
"""

from lta_energy.monitoring.monitor import EnergyEstimate, update_estimate
from lta_energy.monitoring.report import report_energy
import numpy as np
import pytest

from .metered import ABOARD, CELL, follow, Metered, SETTINGS

TEN_MINUTES = 600  # readings
each = pytest.mark.parametrize(
    'seeds',
    [range(16), pytest.param(range(50), marks=pytest.mark.long)],
    ids=lambda some: str(len(some)),
)


@each
def test_the_charge_is_known_to_five_percent_after_ten_minutes(seeds):
    errors, alarms = [], set()
    for seed in seeds:
        cell = Metered(seed, off=True, period=1.0)
        estimate = follow(cell.reading() for _ in range(TEN_MINUTES))
        errors.append((estimate.charge - cell.charge) / estimate.deviation)
        assert estimate.charge == pytest.approx(cell.charge, abs=0.05), seed
        alarms |= set(estimate.watch.faults)
    assert alarms == set()
    # What it says of its own error is neither too little nor far too much.
    assert 0.02 < np.mean(np.square(errors)) < 2.0


@each
def test_the_time_to_empty_is_known_to_ten_percent_at_half_charge(seeds):
    scores = []
    for seed in seeds:
        cell, estimate = Metered(seed, (0.55, 0.75), off=True, period=1.0), EnergyEstimate()
        while cell.charge > 0.5:
            estimate = update_estimate(SETTINGS, ABOARD, estimate, cell.reading())
        told, true = report_energy(SETTINGS, CELL, estimate).empty, cell.lasts()
        assert told.mean == pytest.approx(true, rel=0.10), seed
        scores.append((told.mean - true) / told.deviation)
    assert 0.005 < np.mean(np.square(scores)) < 2.0
