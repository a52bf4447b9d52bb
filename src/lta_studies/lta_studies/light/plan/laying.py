"""How lamps are laid out: as few as cover all, then frequencies, then all heard together."""

from collections.abc import Callable
import math
from typing import Final

from lta_config.errors import BadInput
from lta_studies.light.plan.cover import demand, distinct, fewest, greedy, improved
from lta_studies.light.plan.ear import Ear
from lta_studies.light.plan.floor import Floor
from lta_studies.light.plan.floor_plan import FloorPlan
from lta_studies.light.plan.frequencies import Band, band_of, frequencies
from lta_studies.light.plan.hearing import least_light, light_over, listening, shares, together
from lta_studies.light.plan.layout import Layout, Placed
from lta_studies.light.plan.mounts import Mount
import numpy as np

SEED: Final = 1  # of the search for fewer lamps

Say = Callable[[str], None]


def lay_out(
    plan: FloorPlan,
    ear: Ear,
    floor: Floor,
    mounts: list[Mount],
    overlap: int,
    most: int | None,
    tick: Callable[[], None],
    say: Say,
) -> Layout:
    """
    Return where lamps go, and what is heard of them.

    Parameters
    ----------
    plan, ear, floor, mounts
        Hall, drone, cells, and places for lamps.
    overlap : int
        Lamps that each cell should hear.
    most : int or None
        How many lamps there may be at most.
    tick : callable
        Called once for each place for a lamp.
    say : callable
        Told what is done next.

    Raises
    ------
    BadInput
        If no lamp can be heard anywhere, or there are not enough frequencies.

    """
    kept = [k for k, mount in enumerate(mounts) if mount.name]
    if most is not None and most < len(kept):
        raise BadInput(
            f'{plan.name} has {len(kept)} lamps already, but at most {most} are asked for; raise '
            '--lamps.'
        )
    band = band_of(
        ear.demodulation, ear.light.sample_rate.si, ear.light.samples,
        plan.ambient.mains_frequency.si, plan.lamp.duty.si,
    )  # fmt: skip
    first = frequencies(band, [], 1)[0][0]
    heard, share = listening(plan, ear, mounts[0], first), float(shares(plan, ear).mean())
    least = least_light(heard, share, ear.needed)
    light = light_over(plan, ear, floor, mounts, least, tick)
    alone = light[:, 0] >= least
    if not alone.any():
        raise BadInput(_unheard(plan, ear, least))
    say('choosing')
    cells, needed = distinct(alone, demand(alone, overlap))
    bound = fewest(cells, needed, kept)
    chosen = greedy(cells, needed, kept, len(mounts) if most is None else most)
    chosen = improved(cells, needed, chosen, kept, bound, np.random.default_rng(SEED))
    chosen.sort(key=lambda k: (-round(mounts[k].position[1], 3), mounts[k].position[0]))
    say('hearing all together')
    lamps, order = _named([mounts[k] for k in chosen], band)
    taken, tones = [lamp.mount for lamp in lamps], [lamp.frequency for lamp in lamps]
    snr = together(plan, ear, floor, taken, tones, light[chosen, 1] > 0.0)
    return Layout(
        plan, floor, ear, overlap, lamps, light[chosen, 0], snr, alone.sum(axis=0), len(mounts),
        least, order, bound,
    )  # fmt: skip


def _named(mounts: list[Mount], band: Band) -> tuple[tuple[Placed, ...], int]:
    """Return lamps with names and frequencies, and the order up to which harmonics stay clear."""
    kept = [mount.frequency for mount in mounts if mount.frequency is not None]
    new, order = frequencies(band, kept, len(mounts) - len(kept))
    coming = iter(new)
    return tuple(
        Placed(
            mount.name or f'lamp_{k}',
            mount,
            next(coming) if mount.frequency is None else mount.frequency,
        )
        for k, mount in enumerate(mounts, start=1)
    ), order


def _unheard(plan: FloorPlan, ear: Ear, least: float) -> str:
    vehicle, ambient = ear.vehicle.file.name, plan.ambient.steady.si
    if math.isinf(least):
        return (
            f'{vehicle} hears no lamp in {plan.name}, however bright: the ambient light of '
            f'{ambient:g} lx fills the converter of its diodes or the flicker of the mains drowns '
            'all; plan for less of it, or give the diodes a smaller feedback resistor.'
        )
    return (
        f'{vehicle} hears no lamp of {plan.name} at every heading anywhere: it takes {least:.2g} '
        "lx on a diode that its hull does not shade; hang them nearer to the drone's altitude, or "
        'take brighter ones.'
    )
