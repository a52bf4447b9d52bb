"""Derive health levels and messages from an energy estimate."""

import math

from lta_energy.monitoring.endurance import TimeEstimate
from lta_energy.monitoring.estimate import EnergyEstimate
from lta_energy.monitoring.monitor import MonitorSettings, time_to_empty, time_to_full
from lta_graph.health import HealthLevel
from lta_model.electrical.battery import BatteryModel

Verdict = tuple[HealthLevel, str]
LONGEST = 360_000.0  # s; a hundred hours: longer times are not shown


def assess_battery(
    settings: MonitorSettings, cell: BatteryModel, estimate: EnergyEstimate
) -> Verdict:
    """
    Return health level and message of the battery.

    ERROR means land now and do not take off; WARN means that the reserve is reached.
    """
    if faults := [fault for fault in estimate.watch.faults if fault.level >= HealthLevel.ERROR]:
        # The first fault in the order of the detectors is the likely cause of the others
        return HealthLevel.ERROR, faults[0].sentence
    if estimate.belief is None or estimate.last is None or estimate.stock is None:
        return (
            HealthLevel.ERROR,
            'no usable battery reading yet; until then, the energy reserve counts as reached',
        )
    percent = f'{estimate.charge:.0%} +- {estimate.deviation:.0%}'
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
    return HealthLevel.OK, f'{percent} left{_format_endurance(settings, cell, estimate)}'


def _format_endurance(
    settings: MonitorSettings, cell: BatteryModel, estimate: EnergyEstimate
) -> str:
    """Format the time to empty or to full."""
    empty, full = time_to_empty(settings, cell, estimate), time_to_full(settings, cell, estimate)
    if empty.mean < LONGEST:
        return f', {_format_minutes(empty)} at this power'
    return f', full in {_format_minutes(full)}' if full.mean < LONGEST else ''


def _format_minutes(time: TimeEstimate) -> str:
    return f'{time.mean / 60.0:.0f} +- {math.ceil(time.deviation / 60.0)} min'


def assess_meters(estimate: EnergyEstimate) -> Verdict:
    """Return health level and message of the meter readings."""
    faults = estimate.watch.faults
    if not faults:
        return HealthLevel.OK, 'readings are plausible'
    level = max(fault.level for fault in faults)
    return level, '; '.join(f'{fault.name}: {fault.sentence}' for fault in faults)


def compute_return_margin(estimate: EnergyEstimate) -> Verdict:
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
