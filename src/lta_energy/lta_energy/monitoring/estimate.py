"""Define the energy estimate after a reading."""

import math
from typing import NamedTuple

from lta_energy.faults.fault_monitor import DetectorStates
from lta_energy.monitoring.energy_balance import EnergyBalance
from lta_energy.monitoring.latch import Latch
from lta_energy.monitoring.load import LoadEstimate
from lta_energy.monitoring.reading import MeterReading
from lta_energy.monitoring.reserve import ReserveMargin
from lta_energy.monitoring.soc_ekf import CellState, VoltageInnovation
from lta_energy.monitoring.way_home import TravelEstimate


class EnergyEstimate(NamedTuple):
    """
    Energy estimate after a reading.

    Attributes
    ----------
    belief : CellState or None
        State of the cell; None before the first usable reading.
    load : LoadEstimate
        Power drawn from the cell's chemistry, losses included.
    travel : TravelEstimate or None
        Power and speed of flight.
    stock : ReserveMargin or None
        Charge compared with reserve and way home.
    low : bool
        Whether the charge has reached the reserve, with hysteresis.
    reserve : bool
        Whether the reserve counts as reached: by the charge, or because the estimate is
        unreliable.
    critical : Latch
        Whether the voltage is so low that the drone must land.
    watch : DetectorStates
        State of the fault detectors.
    surprise : VoltageInnovation or None
        Innovation of the newest voltage.
    gap : float
        Time since the previous reading. [s]
    last : MeterReading or None
        The newest reading.
    good : MeterReading or None
        The newest usable reading.
    books : EnergyBalance
        Energy balance since the first usable reading.
    behind : tuple of int
        Stamps of readings received after `last` that lie before it, in ascending order. [ns]

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
        """State of charge; NaN before the first usable reading. [1]"""
        return math.nan if self.belief is None else self.belief.charge

    @property
    def deviation(self) -> float:
        """Standard deviation of the state of charge. [1]"""
        return math.nan if self.belief is None else self.belief.deviation

    @property
    def is_landing_urgent(self) -> bool:
        """Whether to land at once: no estimate, critical voltage, or unreliable readings."""
        return self.belief is None or self.critical.on or self.watch.is_doubtful
