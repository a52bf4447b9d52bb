"""What came out: the lamps with their places and frequencies, and how they are heard."""

from dataclasses import dataclass
from typing import final

from lta_studies.light.plan.floor import FloorGrid
from lta_studies.light.plan.floor_plan import FloorPlan
from lta_studies.light.plan.mounts import LampMount
from lta_studies.light.plan.polygon import Array, Mask
from lta_studies.light.plan.receiver import LightReceiver
import numpy as np


@final
@dataclass(frozen=True, slots=True)
class LayoutLamp:
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
    mount: LampMount
    frequency: float


@final
@dataclass(frozen=True, slots=True)
class LampLayout:
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
    floor: FloorGrid
    ear: LightReceiver
    overlap: int
    lamps: tuple[LayoutLamp, ...]
    light: Array
    snr: Array
    reachable: Array
    places: int
    least: float
    order: int
    bound: int

    @property
    def audible(self) -> Mask:
        """Which lamp is heard over which wanted cell, shape (lamps, cells)."""
        return np.asarray(self.snr >= self.ear.required_snr)

    @property
    def audible_count(self) -> Array:
        """How many lamps are heard over each wanted cell."""
        return np.asarray(self.audible.sum(axis=0))

    @property
    def coverage(self) -> float:
        """Share of the wanted cells that hear as many lamps as they should."""
        return float((self.audible_count >= self.overlap).mean())
