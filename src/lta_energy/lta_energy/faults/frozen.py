"""Detect readings that stay identical to the last bit because a meter or its driver hangs."""

from lta_energy.faults.detector import FaultDetector, Memory, MeterObservation
from lta_energy.faults.dropout import NOTHING
from lta_graph.health import HealthLevel

# With half a count of noise a reading repeats every second time; 5 s at 10 Hz: chance of 1e-15
LONGEST = 5.0  # s
# A panel in the dark really reads a constant zero
DARK = 0.01  # A


def _update_frozen_time(time: float, now: float, before: float, dt: float) -> float:
    """Return how long a value has stayed the same. [s]"""
    return time + dt if now == before else 0.0


def _detect_frozen_cell(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    if observation.before is None or observation.dt <= 0.0:
        return False, memory
    voltage, current = memory
    now, before = observation.reading, observation.before
    # The same condition as `dropout`, which reports it
    if abs(now.voltage) < NOTHING:
        return False, (0.0, 0.0)
    voltage = _update_frozen_time(voltage, now.voltage, before.voltage, observation.dt)
    current = _update_frozen_time(current, now.current, before.current, observation.dt)
    # Either meter may hang separately
    return max(voltage, current) >= LONGEST, (voltage, current)


def _detect_frozen_panel(memory: Memory, observation: MeterObservation) -> tuple[bool, Memory]:
    if observation.before is None or observation.dt <= 0.0:
        return False, memory
    now, before = observation.reading.panel_current, observation.before.panel_current
    time = _update_frozen_time(memory[0], now, before, observation.dt) if abs(now) > DARK else 0.0
    return time >= LONGEST, (time,)


def _describe_frozen_cell(observation: MeterObservation) -> str:
    return (
        f'the measured voltage or current of the battery cell has not changed for {LONGEST:g} '
        's: the power meter hangs; check it'
    )


def _describe_frozen_panel(observation: MeterObservation) -> str:
    return (
        f'the measured current of the solar panel has not changed for {LONGEST:g} s: its power '
        'meter hangs; check it'
    )


DETECTOR = FaultDetector(
    'frozen',
    _detect_frozen_cell,
    _describe_frozen_cell,
    HealthLevel.ERROR,
    spoils=True,
    rise=0.0,
    fall=2.0,
    start=(0.0, 0.0),
)
PANEL = FaultDetector(
    'panel frozen', _detect_frozen_panel, _describe_frozen_panel, HealthLevel.WARN,
    spoils=False, rise=0.0, fall=2.0, start=(0.0,),
)  # fmt: skip
