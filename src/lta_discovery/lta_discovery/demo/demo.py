# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run the demonstration: hide an effect, fly with it, and find it."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
import shutil
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.demo.forecast_gain import measure_forecast_gain
from lta_discovery.demo.hidden_effect import (
    DemoEffect,
    draw_demo_effects,
    fly_hidden,
    HIDDEN_VEHICLE,
)
from lta_discovery.discovery.run import discover_effects, DiscoveryRequest, Tell
from lta_discovery.flights.bags import Role
from lta_report.report import Report

SECONDS: Final = 48.0  # of each flight
FLIGHTS: Final[tuple[tuple[str, Role], ...]] = (
    ('A', 'train'), ('B', 'confirm'), ('C', 'holdout'),
)  # fmt: skip
DEMO_SPACING: Final = 1000  # between the seeds of two demonstrations, so that their flights differ
DEMO_DRAWS: Final = 12  # most effects that are drawn; each takes a quarter of the time of a study


def run_discovery_demo(seed: int, folder: Path, tell: Tell) -> Report:
    """
    Hide an effect that forecasts need, fly three flights with it, and search for it.

    `seed`: of the effect and the flights. `folder`: empty; the flights go into `flights`. Raise
    `BadInput` if forecasts need none of the effects that the seed draws.
    """
    with _remove_if_aborted(folder):
        hidden, bags = draw_clear_effect(seed, folder, tell)
        report = discover_effects(DiscoveryRequest.of_bags(HIDDEN_VEHICLE, bags), tell)
    assert isinstance(report.data, dict)
    truth = {'name': hidden.name, 'value': hidden.value, 'unit': hidden.unit}
    return replace(
        report,
        facts={**report.facts, 'hidden': str(hidden)},
        data={**report.data, 'hidden': truth},
        closing=(*report.closing, f'Hidden: {hidden}.'),
    )


def draw_clear_effect(
    seed: int, folder: Path, tell: Tell
) -> tuple[DemoEffect, Mapping[Role, Sequence[Path]]]:
    """Return the first effect that forecasts of its held-out flight need, and its flights."""
    effects = draw_demo_effects(seed)
    for count in range(1, DEMO_DRAWS + 1):
        hidden = next(effects)
        bags = fly_all(hidden, seed, folder, tell)
        tell('checking that forecasts need the hidden effect', None)
        if measure_forecast_gain(hidden, bags).is_clear:
            return hidden, bags
        tell(f'forecasts do not need effect {count}: drawing another', None)
        shutil.rmtree(folder / 'flights')
    raise BadInput(
        f'Forecasts need none of the {DEMO_DRAWS} effects that seed {seed} draws; choose another '
        '--seed.'
    )


def fly_all(
    hidden: DemoEffect, seed: int, folder: Path, tell: Tell
) -> Mapping[Role, Sequence[Path]]:
    """Simulate the flights of a demonstration; return the bags by role."""
    bags: dict[Role, Sequence[Path]] = {}
    for k, (name, role) in enumerate(FLIGHTS):
        tell(f'simulating flight {name} with the hidden effect', None)
        # Each flight has its own seed
        place = folder / 'flights' / name
        bags[role] = [fly_hidden(hidden, DEMO_SPACING * seed + k, SECONDS, place)]
    return bags


@contextmanager
def _remove_if_aborted(folder: Path) -> Iterator[None]:
    """Remove the flights of an aborted demonstration."""
    try:
        yield
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
