"""Define the result of a plan: lamps with positions, frequencies and reception."""

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
    """A lamp of the layout."""

    name: str  # `lamp_1` and so on, or the name of an existing lamp
    mount: LampMount  # position and direction
    frequency: float  # flicker frequency [Hz]


@final
@dataclass(frozen=True, slots=True)
class LampLayout:
    """Result of a plan."""

    # Inputs
    plan: FloorPlan
    floor: FloorGrid
    ear: LightReceiver
    overlap: int  # number of lamps that each cell should receive
    lamps: tuple[LayoutLamp, ...]  # lamps from top left to bottom right
    # Light and SNR of each lamp over each wanted cell at the worst heading, all lamps on, shape
    # (lamps, cells) [lx, 1]
    light: Array
    snr: Array
    reachable: Array  # number of candidate positions that a cell could receive, shape (cells,)
    places: int  # number of candidate positions
    least: float  # light required to receive a single lamp [lx]
    order: int  # order up to which harmonics are outside the windows of other lamps
    bound: int  # lower bound on the number of lamps for full coverage

    @property
    def is_received(self) -> Mask:
        """Whether each lamp is received in each wanted cell, shape (lamps, cells)."""
        return np.asarray(self.snr >= self.ear.required_snr)

    @property
    def received_count(self) -> Array:
        """Number of lamps received in each wanted cell."""
        return np.asarray(self.is_received.sum(axis=0))

    @property
    def coverage(self) -> float:
        """Share of the wanted cells that receive enough lamps."""
        # All cells have the same area, so a share of cells is a share of area.
        return float((self.received_count >= self.overlap).mean())
