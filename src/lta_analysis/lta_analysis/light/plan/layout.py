"""The lamps laid out: chosen, given frequencies, and heard with all of them on."""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import final

from lta_analysis.light.plan.cover import demand, distinct, fewest, greedy, improved
from lta_analysis.light.plan.ear import Ear
from lta_analysis.light.plan.floor import Floor
from lta_analysis.light.plan.floor_plan import FloorPlan
from lta_analysis.light.plan.frequencies import Band, band_of, frequencies
from lta_analysis.light.plan.hearing import least_light, light_over, listening, together
from lta_analysis.light.plan.mounts import Mount
from lta_analysis.light.plan.polygon import Array, Mask
from lta_config.errors import BadInput
import numpy as np

SEED = 1  # of the search for fewer lamps

Say = Callable[[str], None]


@final
@dataclass(frozen=True, slots=True)
class Placed:
    """
    A lamp of the layout.

    Attributes
    ----------
    name : str
        `lamp_1` and so on, or its own where it was there already.
    mount : Mount
        Place and direction.
    frequency : float
        At which it flickers. [Hz]

    """

    name: str
    mount: Mount
    frequency: float


@final
@dataclass(frozen=True, slots=True)
class Layout:
    """
    What came out.

    Attributes
    ----------
    plan, floor, ear
        What was given.
    overlap : int
        Lamps that each cell should hear.
    lamps : tuple of Placed
        In the order in which the page is read.
    light, snr : ndarray, shape (lamps, cells)
        Of each lamp over each wanted cell at the worst heading, all lamps on. [lx, 1]
    reachable : ndarray of int, shape (cells,)
        How many of all lamps that could be mounted are heard there.
    places : int
        How many places for lamps there were.
    least : float
        Light from which a lamp is heard, were it alone. [lx]
    order : int
        Up to which harmonics of lamps stay out of each other's windows.
    bound : int
        No fewer lamps cover all that can be covered.

    """

    plan: FloorPlan
    floor: Floor
    ear: Ear
    overlap: int
    lamps: tuple[Placed, ...]
    light: Array
    snr: Array
    reachable: Array
    places: int
    least: float
    order: int
    bound: int

    @property
    def heard(self) -> Mask:
        """Which lamp is heard over which wanted cell, shape (lamps, cells)."""
        return np.asarray(self.snr >= self.ear.needed)

    @property
    def count(self) -> Array:
        """How many lamps are heard over each wanted cell."""
        return np.asarray(self.heard.sum(axis=0))

    @property
    def coverage(self) -> float:
        """Share of the wanted cells that hear as many lamps as they should."""
        return float((self.count >= self.overlap).mean())


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
        Hall, drone, cells, and places for lamps, those that are taken first.
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
    least = least_light(listening(plan, ear, mounts[0], first), ear.needed)
    light = light_over(plan, ear, floor, mounts, least, tick)
    alone = light[:, 0] >= least
    if not alone.any():
        raise BadInput(_unheard(plan, ear, least))
    say('choosing')
    cells, needed = distinct(alone, demand(alone, overlap))
    bound = fewest(cells, needed, kept)
    chosen = greedy(cells, needed, kept, len(mounts) if most is None else most)
    chosen = improved(cells, needed, chosen, kept, bound, np.random.default_rng(SEED))
    say('frequencies')
    chosen.sort(key=lambda k: (-round(mounts[k].position[1], 3), mounts[k].position[0]))
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
    faint = 'however bright' if math.isinf(least) else f'which takes {least:.2g} lx'
    return (
        f'No lamp of {plan.name} is heard by {ear.vehicle.file.name} with an SNR of '
        f'{ear.needed:g} ({faint}) at every heading anywhere; hang them nearer to the flight '
        'altitude, or take brighter ones.'
    )
