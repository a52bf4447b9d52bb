"""Where the panels sit, and what the centre of gravity's height does."""

import math
from pathlib import Path
from typing import Final

from lta_config.files import find, load_yaml
from lta_config.typed import typed
from lta_studies.energy.flown import for_seconds
from lta_studies.energy.mounting.page import (
    OVER,
    over_picture,
    STRAIGHT,
    straight_picture,
    swing_picture,
    SWUNG,
)
from lta_studies.energy.mounting.rows import tables
from lta_studies.energy.mounting.run import gains_of, Order, Study
from lta_studies.energy.mounting.run import study as compare
from lta_studies.energy.mounting.straight import begun, END, over
from lta_studies.reproduce.found import Asked, Found, Picture, Value, word
from lta_studies.reproduce.recorded import record, way
import numpy as np

MOUNTS: Final = ('side', 'bottom', 'top')
AHEAD: Final = 0.03  # m


def study(asked: Asked) -> Found:
    """Return the mounts flown straight on, and releases with the weight at three heights."""
    order = Order(load_yaml(find('vehicle', 'gtmab')), MOUNTS, AHEAD, asked.seeds)
    found = compare(order, lambda: None)
    values = {**mounts(found, asked.seeds), **heights(found)}
    command = typed('energy', 'mounting', '--seeds', str(asked.seeds))
    pictures = [
        Picture('straight', 'Straight on at 0.1 m/s', STRAIGHT, straight_picture(found), command,
                '' if asked.quick else recorded(found, asked.folder / 'straight')),
        Picture('over', 'Centre of gravity below, at and above', OVER, over_picture(found),
                command),
        Picture('swing', 'Let go', SWUNG, swing_picture(found), command),
    ]  # fmt: skip
    return Found(values, pictures, tables(found))


def recorded(found: Study, folder: Path) -> str:
    """Record the flight of seed 1 of every mount, panels in place and out of it."""
    for group, all_of in (('in_place', found.shared), ('out_of_place', found.misplaced)):
        for name, each in all_of.items():
            loop = begun(each.fitted, gains_of(each.fitted), 1)
            record(loop, for_seconds(END), folder / f'{name}_{group}')
    return way(folder)


def mounts(found: Study, seeds: int) -> dict[str, Value]:
    """Return swing and carrying of each mount."""
    values: dict[str, Value] = {}
    for name, each in found.shared.items():
        spread = over(each.flights, 'amplitude')
        off = spread.off if seeds > 1 else math.nan
        ends = (spread.mean - off, spread.mean + off)
        values[f'{name}_swing'] = Value(spread.mean, *ends, seeds)
        values[f'{name}_rms'] = Value(over(each.flights, 'rms').mean, seeds=seeds)
        values[f'{name}_spare'] = Value(-found.lacking[name])
    own = found.own['side']
    values['side_out_of_place'] = Value(own.misplacement)
    values['side_misplaced_swing'] = Value(over(found.misplaced['side'].flights, 'swing').mean)
    rms = {name: values[f'{name}_rms'].value for name in MOUNTS}
    assert not any(isinstance(each, str) for each in rms.values())
    values['bottom_by_side'] = Value(float(rms['bottom']) / float(rms['side']), seeds=seeds)
    values['top_by_bottom'] = Value(float(rms['top']) / float(rms['bottom']), seeds=seeds)
    return values


def heights(found: Study) -> dict[str, Value]:
    """Return what becomes of a tilt with the centre of gravity below, at and above."""
    below, at, above = found.overturning
    last = float(at.release.tilt[-1]) / float(at.release.tilt[0])
    return {
        'below_restores': word(
            bool(np.any(below.release.tilt < 0.0)) and not below.release.turned
        ),
        'coincident_restores': word(bool(np.any(at.release.tilt < 0.0))),
        'coincident_left': Value(last),
        'above_flips': word(above.release.turned is not None),
        'above_turned': Value(
            float('nan') if above.release.turned is None else above.release.turned
        ),
    }
