"""Simulate a cell under a constant load until it fails or the time is over."""

from dataclasses import dataclass
from typing import final

from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.charger import advance_power_path, ChargerModel, resting_flow
from lta_report.json_value import ExactArray
import numpy as np

STEP = 0.1  # s
DARK = ChargerModel(tracking=0.0, conversion=0.0, idle=0.0)  # no charging


@final
@dataclass(frozen=True, slots=True)
class DischargeTrace:
    """Voltage [V] and state of charge [1] of a cell over time [s], up to its failure."""

    time: ExactArray
    voltage: ExactArray
    charge: ExactArray
    failed: float | None

    @property
    def voltage_drop(self) -> float:
        """Voltage drop from the first to the last value under load. [V]"""
        return float(self.voltage[0] - self.voltage[-1])


def simulate_discharge(
    cell: BatteryModel, charge: float, power: float, seconds: float
) -> DischargeTrace:
    """Discharge a cell from a state of charge [1] at a constant power [W] for a time [s]."""
    flow, rows, failed = resting_flow(charge), [], None
    for k in range(round(seconds / STEP)):
        # No light (0 W/m2) and a charger that does nothing
        flow = advance_power_path(cell, DARK, flow, 0.0, power, STEP)
        if not flow.fed:
            failed = k * STEP
            break
        rows.append((k * STEP, flow.voltage, flow.charge))
    # The copy makes each column contiguous.
    time, voltage, left = np.array(rows, dtype=np.float64).T.copy()
    return DischargeTrace(time, voltage, left, failed)
