"""The demonstration: something is hidden, flown, found, added and shown."""

from pathlib import Path
import shutil
from typing import Final

from lta_discovery.demo.hidden_effect import DemoEffect, draw_demo_effect, fly_hidden, VEHICLE
from lta_discovery.flights.bags import Role
from lta_discovery.run import discover_effects, DiscoveryRequest, DiscoveryResult, Tell

SECONDS: Final = 48.0  # of each flight
FLIGHTS: Final[tuple[tuple[str, Role], ...]] = (
    ('A', 'train'), ('B', 'confirm'), ('C', 'holdout'),
)  # fmt: skip
APART: Final = 1000  # between the seeds of two demonstrations: no two flights are alike


def demonstrate_discovery(
    seed: int, folder: Path, tell: Tell
) -> tuple[DemoEffect, DiscoveryResult]:
    """
    Hide an effect, fly three flights with it, and look for it.

    Parameters
    ----------
    seed : int
        Decides what is hidden, how large it is, and how it is flown.
    folder : Path
        Empty; the flights go into `flights`.
    tell : callable
        Told what is being done.

    """
    hidden, bags = draw_demo_effect(seed), {}
    try:
        for k, (name, role) in enumerate(FLIGHTS):
            tell(f'flying {name} with something hidden', None)
            place = folder / 'flights' / name
            bags[role] = [fly_hidden(hidden, APART * seed + k, SECONDS, place)]
        return hidden, discover_effects(DiscoveryRequest(VEHICLE, bags, seed), folder, tell)
    except BaseException:
        shutil.rmtree(folder)  # flights of a demonstration that nobody saw through
        raise
