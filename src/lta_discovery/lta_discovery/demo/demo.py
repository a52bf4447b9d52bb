"""The demonstration: something is hidden, flown, found, added and shown."""

from pathlib import Path
import shutil
from typing import Final

from lta_discovery.demo.hidden import drawn, fly_hidden, Hidden, VEHICLE
from lta_discovery.flights.bags import Role
from lta_discovery.run import Asked, discover, Discovered, Tell

SECONDS: Final = 48.0  # of each flight
FLIGHTS: Final[tuple[tuple[str, Role], ...]] = (
    ('A', 'train'), ('B', 'confirm'), ('C', 'holdout'),
)  # fmt: skip
APART: Final = 1000  # between the seeds of two demonstrations: no two flights are alike


def demonstrate(seed: int, folder: Path, tell: Tell) -> tuple[Hidden, Discovered]:
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
    hidden, bags = drawn(seed), {}
    try:
        for k, (name, role) in enumerate(FLIGHTS):
            tell(f'flying {name} with something hidden', None)
            place = folder / 'flights' / name
            bags[role] = [fly_hidden(hidden, APART * seed + k, SECONDS, place)]
        return hidden, discover(Asked(VEHICLE, bags, seed), folder, tell)
    except BaseException:
        shutil.rmtree(folder)  # flights of a demonstration that nobody saw through
        raise
