"""Run the demonstration: hide an effect, fly with it, and find it."""

from pathlib import Path
import shutil
from typing import Final

from lta_discovery.demo.hidden_effect import DemoEffect, fly_hidden, VEHICLE
from lta_discovery.flights.bags import Role
from lta_discovery.run import discover_effects, DiscoveryRequest, DiscoveryResult, Tell

SECONDS: Final = 48.0  # of each flight
FLIGHTS: Final[tuple[tuple[str, Role], ...]] = (
    ('A', 'train'), ('B', 'confirm'), ('C', 'holdout'),
)  # fmt: skip
APART: Final = 1000  # between the seeds of two demonstrations, so that their flights differ


def run_discovery_demo(hidden: DemoEffect, seed: int, folder: Path, tell: Tell) -> DiscoveryResult:
    """
    Hide an effect, fly three flights with it, and search for it.

    `seed`: of the flights. `folder`: empty; the flights go into `flights`.
    """
    bags = {}
    try:
        for k, (name, role) in enumerate(FLIGHTS):
            tell(f'simulating flight {name} with the hidden effect', None)
            place = folder / 'flights' / name
            # Each flight has its own seed
            bags[role] = [fly_hidden(hidden, APART * seed + k, SECONDS, place)]
        return discover_effects(DiscoveryRequest(VEHICLE, bags, seed), folder, tell)
    except BaseException:
        shutil.rmtree(folder)  # remove the flights of an aborted demonstration
        raise
