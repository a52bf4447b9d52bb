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
    """Energy estimate after a reading."""

    belief: CellState | None = None  # state of the cell; None before the first usable reading
    load: LoadEstimate = LoadEstimate()  # power drawn from the cell's chemistry, losses included
    travel: TravelEstimate | None = None  # power and speed of flight
    stock: ReserveMargin | None = None  # charge compared with reserve and way home
    low: bool = False  # whether the charge has reached the reserve, with hysteresis
    # Whether the reserve counts as reached: by the charge, or because the estimate is unreliable
    reserve: bool = True
    critical: Latch = Latch()  # whether the voltage is so low that the drone must land
    watch: DetectorStates = DetectorStates()  # state of the fault detectors
    surprise: VoltageInnovation | None = None  # innovation of the newest voltage
    gap: float = 0.0  # time since the previous reading [s]
    last: MeterReading | None = None  # the newest reading
    good: MeterReading | None = None  # the newest usable reading
    books: EnergyBalance = EnergyBalance()  # energy balance since the first usable reading
    # Stamps of readings received after `last` that lie before it, in ascending order [ns]
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
