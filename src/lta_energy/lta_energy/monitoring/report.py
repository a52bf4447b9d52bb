# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Report an energy estimate: times to empty and full, health levels and messages."""

import math
from typing import NamedTuple

from lta_energy.monitoring.faults import MeterFault
from lta_energy.monitoring.monitor import EnergyEstimate, MonitorSettings
from lta_energy.monitoring.outlook import (
    estimate_charging_time,
    estimate_discharge_time,
    mean_load_deviation,
    TimeEstimate,
    UNKNOWN_TIME,
)
from lta_graph.health import HealthLevel
from lta_model.electrical.battery import BatteryModel

Verdict = tuple[HealthLevel, str]
LONGEST_SHOWN = 360_000.0  # s; a hundred hours: longer times are not shown


class EnergyReport(NamedTuple):
    """What is reported of an energy estimate."""

    estimate: EnergyEstimate  # what it is derived from
    # Time to empty and to full at the mean load; infinite while the cell is not drained or not
    # charged
    empty: TimeEstimate
    full: TimeEstimate
    # Health level and message of the battery, the meter readings and the way home
    battery: Verdict
    meters: Verdict
    way: Verdict


def report_energy(
    settings: MonitorSettings, cell: BatteryModel, estimate: EnergyEstimate
) -> EnergyReport:
    """Derive the report from an estimate."""
    belief, load = estimate.belief, estimate.load
    empty = full = UNKNOWN_TIME
    if belief is not None:
        deviation = mean_load_deviation(load, settings.smoothing, settings.outlook)
        empty = estimate_discharge_time(cell, belief, load.mean, deviation)
        full = estimate_charging_time(cell, belief, load.mean, deviation)
    return EnergyReport(
        estimate,
        empty,
        full,
        _assess_battery(settings, estimate, empty, full),
        _assess_meters(estimate.watch.faults),
        _assess_way_home(estimate),
    )


def _assess_battery(
    settings: MonitorSettings, estimate: EnergyEstimate, empty: TimeEstimate, full: TimeEstimate
) -> Verdict:
    """
    Return health level and message of the battery.

    ERROR means land now and do not take off; WARN means that the reserve is reached.
    """
    for fault in estimate.watch.faults:
        # The first fault in the order of the detectors is the likely cause of the others
        if fault.level >= HealthLevel.ERROR:
            return HealthLevel.ERROR, fault.sentence
    if estimate.belief is None or estimate.last is None or estimate.stock is None:
        return (
            HealthLevel.ERROR,
            'no usable battery reading yet; until then, the energy reserve counts as reached',
        )
    percent = f'{estimate.belief.charge:.0%} +- {estimate.belief.deviation:.0%}'
    if estimate.critical.on:
        return (
            HealthLevel.ERROR,
            f'the battery voltage is only {estimate.last.voltage:.2f} V: land now',
        )
    # Reached by the charge itself; otherwise `reserve` is set by the uncertainty
    if estimate.low:
        return HealthLevel.WARN, (
            f'energy reserve reached: {percent} of the charge left; reserve '
            f'{settings.reserve:.0%}, flight home {estimate.stock.home:.1%}'
        )
    if estimate.reserve:
        return (
            HealthLevel.WARN,
            f'the estimated charge of {percent} is too uncertain, so the energy reserve '
            'counts as reached',
        )
    if empty.mean < LONGEST_SHOWN:
        return HealthLevel.OK, f'{percent} left, {_format_minutes(empty)} at this power'
    if full.mean < LONGEST_SHOWN:
        return HealthLevel.OK, f'{percent} left, full in {_format_minutes(full)}'
    return HealthLevel.OK, f'{percent} left'


def _format_minutes(time: TimeEstimate) -> str:
    return f'{time.mean / 60.0:.0f} +- {math.ceil(time.deviation / 60.0)} min'


def _assess_meters(faults: tuple[MeterFault, ...]) -> Verdict:
    """Return health level and message of the meter readings."""
    if not faults:
        return HealthLevel.OK, 'readings are plausible'
    level = max(fault.level for fault in faults)
    return level, '; '.join(f'{fault.name}: {fault.sentence}' for fault in faults)


def _assess_way_home(estimate: EnergyEstimate) -> Verdict:
    """Return the distance home and the energy left beyond the way home and the reserve."""
    stock = estimate.stock
    if stock is None or estimate.last is None or estimate.last.where is None:
        return (
            HealthLevel.OK,
            'the position of the drone is unknown, so no energy is reserved for the flight home',
        )
    text = (
        f'the start is {estimate.last.where.distance:.1f} m away; energy beyond the flight '
        f'home and the reserve: {stock.spare:.0f} J'
    )
    return (HealthLevel.WARN if stock.spare <= 0.0 else HealthLevel.OK), text
