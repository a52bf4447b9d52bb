"""A flight that does not end: from lantern to lantern and round again, on an endless battery."""

from pathlib import Path
from typing import Final

import add_paths  # noqa: F401
from command import ROOT

ROUNDS: Final = 1000  # of three lanterns, half a minute each: more than a day takes
ENDLESS: Final = '86400 s'  # the longest that a scenario takes
STRATEGY: Final = 'homing'  # says when it has arrived, which a route needs


def endless(folder: Path) -> dict[str, object]:
    """Write the shipped scene and vehicle without an end; return what to fly, by its kind."""
    scene = _changed(
        'scenarios/warehouse_patrol.yaml', folder,
        {'route: [aisle, gate]': f'route: [{", ".join(("aisle", "gate", "dock") * ROUNDS)}]',
         'time_limit: 180 s': f'time_limit: {ENDLESS}'},
    )  # fmt: skip
    vehicle = _changed('vehicles/gtmab.yaml', folder, {'250, unit: mA h': '250, unit: A h'})
    return {'scenario': scene, 'vehicle': vehicle, 'strategy': STRATEGY}


def _changed(name: str, folder: Path, changes: dict[str, str]) -> Path:
    """Write a shipped file with other words into a folder, and return its path."""
    text = (ROOT / 'config' / name).read_text()
    for old, new in changes.items():
        assert text.count(old) == 1, f'{name} no longer says {old!r} once'
        text = text.replace(old, new)
    path = folder / Path(name).name
    path.write_text(text)
    return path
