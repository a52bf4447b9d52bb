# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect faulty readings of the power meters: thirteen detectors in one table, `DETECTORS`.

A detector looks at one reading and at a memory of its own, and returns a message while its
condition holds. The fault is active after the condition has held for `rise`, and cleared after it
has been absent for `fall`.
"""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import final, NamedTuple

from lta_energy.monitoring.meters import MeterReading
from lta_graph.health import HealthLevel
from lta_model.electrical.battery import BatteryModel

# Internal state of a detector, whose meaning only that detector knows
Memory = tuple[float, ...]

DEAD_VOLTAGE = 0.1  # V; no computer runs at such a voltage, so the reading is wrong
# [V] Below, a LiPo cell is damaged; 0.25 V above full charge it becomes dangerous.
LOWEST_VOLTAGE, HIGHEST_VOLTAGE = 2.0, 4.45
HARMLESS_REPEATS = 2.0  # of one stamp
# With half a count of noise a reading repeats every second time; 5 s at 10 Hz: chance of 1e-15
FROZEN_FOR = 5.0  # s
DARK_CURRENT = 0.01  # A: a panel in the dark really reads a constant zero
LONGEST_GAP = 1.0  # s; ten periods of the meters, as long as the navigator waits by default
SWAP_SURPRISE = 5.0  # standard deviations of the voltage
OFFICE_LIGHT = 500.0  # lx
SHORTED_VOLTAGE = 0.3  # V; less than half of what one silicon cell gives in that light
DOUBTFUL_POWER = 0.05  # W; ten times what the meters' offsets can amount to
FORGETTING_TIME = 10.0  # s: time constant with which old changes are forgotten
EXCITATION = 0.02  # A2; a step of 0.14 A, whose slope a voltage noise of 3 mV blurs by 0.02 ohm
# Halfway between 0 and minus the resistance, the slope expected for a reversed sign
REVERSED_SLOPE = -0.5  # of the resistance
# Voltage change that noise and relaxation can cause without a change of current
VOLTAGE_WANDER = 0.02  # V
STAMP_ROUNDING = 1e-6  # s; of a sum of differences of stamps


class MeterObservation(NamedTuple):
    """Input of a detector."""

    reading: MeterReading
    before: MeterReading | None  # the previous reading; None at the first
    dt: float  # time between the two stamps; 0 at the first, negative where stamps go back [s]
    cell: BatteryModel  # the cell of the vehicle file
    surprise: float = 0.0  # voltage innovation in standard deviations; 0 without a prediction
    back: float = 0.0  # by how much the clock was set back at this reading; otherwise 0 [s]


@final
@dataclass(frozen=True, slots=True)
class FaultDetector:
    """One kind of faulty reading."""

    name: str  # name in messages and diagnostics
    # `find(memory, observation) -> (message, memory)`: what is wrong and what to check, or ''
    find: Callable[[Memory, MeterObservation], tuple[str, Memory]]
    level: HealthLevel  # at ERROR the energy is unreliable: the drone lands and does not take off
    spoils: bool  # whether a reading that fulfils the condition is unusable for the estimate
    # Time that the condition must hold to report the fault, and be absent to clear it [s]
    rise: float
    fall: float
    start: Memory = ()  # memory before the first reading


def _find_not_a_number(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find a voltage or current that is NaN or outside the range of the meter."""
    reading = observation.reading
    if reading.is_usable:
        return '', memory
    if math.isfinite(reading.voltage) and math.isfinite(reading.current):
        values = f'{reading.voltage:.3g} V and {reading.current:.3g} A'
        return f'the battery readings of {values} are impossible: check the power meter', memory
    return (
        'the measured voltage or current of the battery is not a number: check the power meter',
        memory,
    )


def _find_dropout(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find a meter without output: the drone runs, but the cell reads zero volts."""
    voltage = observation.reading.voltage
    if not abs(voltage) < DEAD_VOLTAGE:
        return '', memory
    return (
        f'the power meter reads {voltage:.2f} V for the battery cell: the supply has failed, or a '
        'wire of the meter is broken; check the wiring',
        memory,
    )


def _find_stale_stamp(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find stamps that do not advance: an old message is repeated."""
    if observation.before is None or observation.dt > 0.0:
        return '', (0.0,)
    count = memory[0] + 1.0
    if count <= HARMLESS_REPEATS:
        return '', (count,)
    return (
        'the time stamps of the battery messages do not advance: the publisher repeats an old '
        'message',
        (count,),
    )


def _frozen_time(time: float, now: float, before: float, dt: float) -> float:
    """Return how long a value has stayed the same to the last bit [s]."""
    return time + dt if now == before else 0.0


def _find_frozen_cell(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find readings that stay identical because a meter or its driver hangs."""
    if observation.before is None or observation.dt <= 0.0:
        return '', memory
    voltage, current = memory
    now, before = observation.reading, observation.before
    # A dropout, which has its own detector
    if abs(now.voltage) < DEAD_VOLTAGE:
        return '', (0.0, 0.0)
    voltage = _frozen_time(voltage, now.voltage, before.voltage, observation.dt)
    current = _frozen_time(current, now.current, before.current, observation.dt)
    # Either meter may hang separately
    if not max(voltage, current) >= FROZEN_FOR:
        return '', (voltage, current)
    return (
        'the measured voltage or current of the battery cell has not changed for '
        f'{FROZEN_FOR:g} s: the power meter hangs; check it',
        (voltage, current),
    )


def _find_implausible_voltage(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find a voltage that no cell of this kind can have."""
    voltage = observation.reading.voltage
    if not (DEAD_VOLTAGE <= abs(voltage) < LOWEST_VOLTAGE or voltage > HIGHEST_VOLTAGE):
        return '', memory
    return (
        f'the measured battery voltage of {voltage:.2f} V is outside the range of a LiPo cell '
        f'({LOWEST_VOLTAGE:g} to {HIGHEST_VOLTAGE:g} V): check the power meter and its unit',
        memory,
    )


def _find_reversed_sign(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """
    Find a battery current with the wrong sign, by either of two physical constraints.

    The cell cannot absorb more power than the panel delivers. And its terminal voltage rises with
    the charging current, by the resistance: a negative slope of voltage over current means a
    reversed sign, also in bright light. The slope is a least-squares fit to recent changes.
    """
    reading = observation.reading
    if not reading.is_usable:
        return '', memory
    squares, products = _sum_changes(memory, observation)
    supplied = reading.plausible_panel_power
    if math.isfinite(reading.panel_power) and reading.cell_power > supplied + DOUBTFUL_POWER:
        message = (
            f'the battery cell takes up {reading.cell_power:.2f} W, but the solar panel gives '
            f'only {supplied:.2f} W: check the sign of the measured current'
        )
        return message, (squares, products)
    # Least-squares slope dV/dI; without enough excitation it is undetermined
    slope = products / squares if squares > EXCITATION else 0.0
    if not slope < REVERSED_SLOPE * observation.cell.resistance:
        return '', (squares, products)
    message = (
        'the battery voltage falls while the current charges it: check the sign of the measured '
        'current'
    )
    return message, (squares, products)


def _sum_changes(memory: Memory, observation: MeterObservation) -> tuple[float, float]:
    """Return the decayed sums of squared current changes and of current times voltage changes."""
    squares, products = memory
    before, now = observation.before, observation.reading
    # Across a longer gap the open-circuit voltage changes too
    if before is None or not before.is_usable or not 0.0 < observation.dt < 1.0:
        return squares, products
    decay = math.exp(-observation.dt / FORGETTING_TIME)
    current = now.current - before.current
    voltage = now.voltage - before.voltage
    # A larger voltage change has another cause than the resistance: do not use it
    if abs(voltage) > 2.0 * observation.cell.resistance * abs(current) + VOLTAGE_WANDER:
        return decay * squares, decay * products
    return decay * squares + current * current, decay * products + voltage * current


def _find_brown_out(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find a cell below its cut-off voltage, where the electronics may reset at any moment."""
    reading, cutoff = observation.reading, observation.cell.discharge_cutoff
    # Below, it is a dropout
    if not DEAD_VOLTAGE <= reading.voltage <= cutoff:
        return '', memory
    return (
        f'brown-out: the battery cell has {reading.voltage:.2f} V under a load of '
        f'{-reading.current:.2f} A, at or below its cut-off voltage of {cutoff:.2f} V; land and '
        'charge it',
        memory,
    )


def _find_cell_swap(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find an exchanged cell: a voltage jump that neither charge nor load explains."""
    # A hanging current meter makes the voltage look surprising: distrust a repeated current
    now, before = observation.reading, observation.before
    repeats = before is not None and now.current == before.current
    if not observation.surprise > SWAP_SURPRISE or repeats:
        return '', memory
    return (
        'the battery voltage jumped by more than charge and load can explain: was the cell '
        'replaced? The estimate of the charge starts again',
        memory,
    )


def _find_gap(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find a gap between readings, during which the charge flow is unknown."""
    if not observation.dt > LONGEST_GAP:
        return '', memory
    return (
        f'no battery reading for more than {LONGEST_GAP:g} s: the estimate of the charge is less '
        'certain',
        memory,
    )


def _find_clock_reset(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find that the clock of the readings was set back; see `monitor.shift_stamps`."""
    if not observation.back > 0.0:
        return '', memory
    return (
        f'the clock of the battery readings was set back by {observation.back:.1f} s: energy used '
        'in that time is not counted',
        memory,
    )


def _find_missing_panel(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find a panel that is not measured."""
    if math.isfinite(observation.reading.panel_power):
        return '', memory
    return 'the power of the solar panel is not measured and counts as 0 W', memory


def _find_panel_short(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find an illuminated panel without voltage."""
    voltage, light = observation.reading.panel_voltage, observation.reading.illuminance
    # NaN (not measured) makes either comparison false
    if not (light > OFFICE_LIGHT and voltage < SHORTED_VOLTAGE):
        return '', memory
    return (
        f'the solar panel has only {voltage:.2f} V at {light:.0f} lx: the panel or its charger is '
        'short-circuited; check the wiring',
        memory,
    )


def _find_frozen_panel(memory: Memory, observation: MeterObservation) -> tuple[str, Memory]:
    """Find a current of the panel that stays identical because its meter hangs."""
    if observation.before is None or observation.dt <= 0.0:
        return '', memory
    now, before = observation.reading.panel_current, observation.before.panel_current
    lit = abs(now) > DARK_CURRENT
    time = _frozen_time(memory[0], now, before, observation.dt) if lit else 0.0
    if time < FROZEN_FOR:
        return '', (time,)
    return (
        f'the measured current of the solar panel has not changed for {FROZEN_FOR:g} s: its '
        'power meter hangs; check it',
        (time,),
    )


ERROR, WARN = HealthLevel.ERROR, HealthLevel.WARN
# Order of the messages, and of suppression in `update_detectors`: causes before their symptoms.
# Name, condition, level, whether it spoils the reading, rise and fall [s], memory
DETECTORS: tuple[FaultDetector, ...] = (
    FaultDetector('not a number', _find_not_a_number, ERROR, True, 0.0, 2.0),
    FaultDetector('dropout', _find_dropout, ERROR, True, 0.0, 2.0),
    # Such readings never reach the filter, because their stamp is not newer
    FaultDetector('clock', _find_stale_stamp, ERROR, False, 0.0, 2.0, (0.0,)),
    FaultDetector('frozen', _find_frozen_cell, ERROR, True, 0.0, 2.0, (0.0, 0.0)),
    FaultDetector('implausible', _find_implausible_voltage, ERROR, True, 0.3, 2.0),
    FaultDetector('reversed current', _find_reversed_sign, ERROR, True, 0.3, 5.0, (0.0, 0.0)),
    # The reading itself is correct and still informs the filter; two readings at 10 Hz
    FaultDetector('brown-out', _find_brown_out, ERROR, False, 0.2, 5.0),
    # Three readings at 10 Hz, so that one outlier does not reset the charge
    FaultDetector('swapped', _find_cell_swap, ERROR, True, 0.3, 10.0),
    FaultDetector('gap', _find_gap, WARN, False, 0.0, 5.0),
    # The event is visible in one reading only
    FaultDetector('set back', _find_clock_reset, WARN, False, 0.0, 5.0),
    FaultDetector('panel not measured', _find_missing_panel, WARN, False, 0.0, 1.0),
    FaultDetector('panel short', _find_panel_short, WARN, False, 1.0, 2.0),
    FaultDetector('panel frozen', _find_frozen_panel, WARN, False, 0.0, 2.0, (0.0,)),
)
FIRST_MEMORIES = tuple(detector.start for detector in DETECTORS)
SWAPPED_INDEX = [detector.name for detector in DETECTORS].index('swapped')


class Latch(NamedTuple):
    """Whether it is on, and how long its condition has disagreed with that [s]."""

    on: bool = False
    since: float = 0.0


def update_latch(latch: Latch, condition: bool, dt: float, rise: float, fall: float) -> Latch:
    """
    Update the latch with its condition after a time step.

    `dt`: time since the last update [s]. `rise`, `fall`: time that the condition must hold to
    switch on, and be absent to switch off; 0 is at once [s].
    """
    if condition == latch.on:
        return Latch(latch.on, 0.0)
    since = latch.since + dt
    if since + STAMP_ROUNDING >= (rise if condition else fall):
        return Latch(condition, 0.0)
    return Latch(latch.on, since)


class MeterFault(NamedTuple):
    """An active fault, with the message from the last time that its condition held."""

    name: str
    level: HealthLevel
    sentence: str


class DetectorStates(NamedTuple):
    """State of all detectors; every tuple is in the order of `DETECTORS`."""

    memories: tuple[Memory, ...] = FIRST_MEMORIES  # internal state of each detector
    latches: tuple[Latch, ...] = (Latch(),) * len(DETECTORS)  # whether each fault is active
    # Whether each condition holds for the newest reading
    seen: tuple[bool, ...] = (False,) * len(DETECTORS)
    # Message from the last time that each condition held
    sentences: tuple[str, ...] = ('',) * len(DETECTORS)
    faults: tuple[MeterFault, ...] = ()  # the active faults
    is_unusable: bool = False  # whether the newest reading must not be used to estimate the cell
    is_doubtful: bool = False  # whether an active fault makes the energy estimate unreliable


def update_detectors(watch: DetectorStates, observation: MeterObservation) -> DetectorStates:
    """Update all detectors with one reading."""
    memories, seen, sentences, latches, faults = [], [], [], [], []
    is_unusable = is_doubtful = False
    # Stamps that go back must not shorten the delay of a latch
    dt = max(observation.dt, 0.0)
    for detector, before, latch, last_message in zip(
        DETECTORS, watch.memories, watch.latches, watch.sentences, strict=True
    ):
        message, memory = detector.find(before, observation)
        latch = update_latch(latch, bool(message), dt, detector.rise, detector.fall)
        memories.append(memory)
        seen.append(bool(message))
        sentences.append(message or last_message)
        latches.append(latch)
        if latch.on:
            faults.append(MeterFault(detector.name, detector.level, sentences[-1]))
            is_doubtful |= detector.level >= ERROR
        if message:
            is_unusable |= detector.spoils
            # A grave fault explains the voltage: later detectors (cell swap) must not react to it
            if detector.level >= ERROR:
                observation = observation._replace(surprise=0.0)
    return DetectorStates(
        tuple(memories),
        tuple(latches),
        tuple(seen),
        tuple(sentences),
        tuple(faults),
        is_unusable,
        is_doubtful,
    )
