"""Define the energy estimate after a reading."""

import math
from typing import NamedTuple

from lta_energy.faults.all_detectors import DetectorStates
from lta_energy.monitoring.energy_balance import EnergyBalance
from lta_energy.monitoring.latch import Latch
from lta_energy.monitoring.load import LoadEstimate
from lta_energy.monitoring.reading import MeterReading
from lta_energy.monitoring.reserve import ReserveMargin
from lta_energy.monitoring.soc_ekf import CellState, VoltageInnovation
from lta_energy.monitoring.way_home import TravelEstimate


class EnergyEstimate(NamedTuple):
    """
    What is known after a reading.

    Attributes
    ----------
    belief : Belief or None
        Of the cell; None before the first usable reading.
    load : Load
        Power that leaves the cell's chemistry, losses included.
    travel : Travel or None
        What flying takes.
    stock : Stock or None
        The charge against reserve and way home.
    low : bool
        Whether the reserve is reached by the charge, with hysteresis.
    reserve : bool
        Whether it counts as reached: by the charge, or because the energy is doubtful.
    critical : Latch
        Whether the voltage is so low that nothing but landing is left.
    watch : Watch
        What the detectors of bad readings know.
    surprise : Surprise or None
        How far the newest voltage was off what was expected.
    gap : float
        Time since the reading before. [s]
    last : Reading or None
        The newest reading.
    good : Reading or None
        The newest one that no detector spoilt.
    books : Books
        Energy since the first good reading.
    behind : tuple of int
        Stamps of readings after `last` that lie before it and came in order. [ns]

    """

    belief: CellState | None = None
    load: LoadEstimate = LoadEstimate()
    travel: TravelEstimate | None = None
    stock: ReserveMargin | None = None
    low: bool = False
    reserve: bool = True
    critical: Latch = Latch()
    watch: DetectorStates = DetectorStates()
    surprise: VoltageInnovation | None = None
    gap: float = 0.0
    last: MeterReading | None = None
    good: MeterReading | None = None
    books: EnergyBalance = EnergyBalance()
    behind: tuple[int, ...] = ()

    @property
    def charge(self) -> float:
        """State of charge, NaN before the first usable reading. [1]"""
        return math.nan if self.belief is None else self.belief.charge

    @property
    def deviation(self) -> float:
        """Standard deviation of the state of charge. [1]"""
        return math.nan if self.belief is None else self.belief.deviation

    @property
    def is_urgent(self) -> bool:
        """Whether to come down at once: a cell that gives way, or readings that mean nothing."""
        return self.belief is None or self.critical.on or self.watch.is_doubtful
