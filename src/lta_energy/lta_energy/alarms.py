"""What a person should hear about the energy: levels and sentences, drawn from an estimate."""

import math

from lta_energy.battery import Battery
from lta_energy.monitor import Estimate, MonitorSettings, Reading, time_to_empty
from lta_graph.health import Level

CRITICAL_VOLTAGE = 3.2  # V under load; Bitcraze's low-battery limit
DOUBTFUL_POWER = 0.05  # W; ten times what the meters' offsets can amount to
LONGEST_GAP = 1.0  # s; the current is taken as straight between two readings

Verdict = tuple[Level, str]


def battery(settings: MonitorSettings, cell: Battery, estimate: Estimate) -> Verdict:
    """Return how the cell stands."""
    if estimate.last is None:
        return Level.WARN, 'no usable reading of the battery yet; the reserve counts as reached'
    percent = f'{estimate.charge:.0%}'
    if estimate.last.voltage <= CRITICAL_VOLTAGE:
        return Level.ERROR, f'the battery gives only {estimate.last.voltage:.2f} V: land now'
    if estimate.reserve:
        return Level.WARN, f'battery low: {percent} left, reserve {settings.reserve:.0%}'
    left = time_to_empty(cell, estimate)
    lasts = f', {left / 60.0:.0f} min at this power' if math.isfinite(left) else ''
    return Level.OK, f'{percent} left{lasts}'


def meters(estimate: Estimate, reading: Reading) -> Verdict:
    """Return whether the readings can be believed."""
    if not reading.usable:
        return Level.ERROR, 'voltage or current is not a number: check the power meter'
    if reading.power > reading.income + DOUBTFUL_POWER:
        return Level.ERROR, (
            f'the cell takes up {reading.power:.2f} W but the panel gives '
            f'{reading.income:.2f} W: check the sign of the current'
        )
    if not math.isfinite(reading.harvest):
        return Level.WARN, 'the power of the panel is not measured and counts as 0 W'
    if estimate.gap > LONGEST_GAP:
        return Level.WARN, f'{estimate.gap:.1f} s without a reading: the charge is less certain'
    if not estimate.rested:
        return Level.WARN, 'the first voltage was read under load: the charge is less certain'
    return Level.OK, 'readings are plausible'
