"""
Detect a battery current with the wrong sign, by either of two physical constraints.

The cell cannot absorb more power than the panel delivers. And its terminal voltage rises with the
charging current, by the resistance: a negative slope of voltage over current means a reversed
sign, also in bright light. The slope is a least-squares fit to recent changes.
"""

import math

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_graph.health import HealthLevel

DOUBTFUL_POWER = 0.05  # W; ten times what the meters' offsets can amount to
# Time constant with which old changes are forgotten
MEMORY = 10.0  # s
EXCITED = 0.02  # A2; a step of 0.14 A, whose slope a voltage noise of 3 mV blurs by 0.02 ohm
# Halfway between 0 and minus the resistance, the slope expected for a reversed sign
AGAINST = -0.5  # of the resistance
# Voltage change that noise and relaxation can cause without a change of current
NOISE = 0.02  # V


def _detect_reversed_sign(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    reading = observation.reading
    if not reading.is_usable:
        return False, memory
    squares, products = _sum_changes(memory, observation)
    # Least-squares slope dV/dI; without enough excitation it is undetermined
    slope = products / squares if squares > EXCITED else 0.0
    against = slope < AGAINST * observation.cell.resistance
    too_much = (
        math.isfinite(reading.panel_power)
        and reading.cell_power > reading.plausible_panel_power + DOUBTFUL_POWER
    )
    return against or too_much, (squares, products)


def _sum_changes(memory: Memory, observation: MeterObservation) -> tuple[float, float]:
    """Return the decayed sums of squared current changes and of current times voltage changes."""
    squares, products = memory
    before, now = observation.before, observation.reading
    # Across a longer gap the open-circuit voltage changes too
    if before is None or not before.is_usable or not 0.0 < observation.dt < 1.0:
        return squares, products
    decay = math.exp(-observation.dt / MEMORY)
    current = now.current - before.current
    voltage = now.voltage - before.voltage
    # A larger voltage change has another cause than the resistance: do not use it
    if abs(voltage) > 2.0 * observation.cell.resistance * abs(current) + NOISE:
        return decay * squares, decay * products
    return decay * squares + current * current, decay * products + voltage * current


def _describe_reversed_sign(observation: MeterObservation) -> str:
    reading = observation.reading
    if reading.cell_power > reading.plausible_panel_power + DOUBTFUL_POWER:
        return (
            f'the battery cell takes up {reading.cell_power:.2f} W, but the solar panel '
            f'gives only {reading.plausible_panel_power:.2f} W: check the sign of the '
            'measured current'
        )
    return (
        'the battery voltage falls while the current charges it: check the sign of the '
        'measured current'
    )


DETECTOR = FaultDetector(
    'reversed current', _detect_reversed_sign, _describe_reversed_sign, HealthLevel.ERROR,
    spoils=True, rise=0.3, fall=5.0, start=(0.0, 0.0),
)  # fmt: skip
