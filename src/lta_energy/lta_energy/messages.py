# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert between energy data and ROS messages."""

import math

from geometry_msgs.msg import TwistWithCovarianceStamped
from lta_config.covariances import has_estimate
from lta_energy.monitoring.meters import MeterReading, PowerSystem, TravelState
from lta_energy.monitoring.monitor import EnergyEstimate, MonitorSettings
from lta_energy.monitoring.outlook import reachable_distance
from lta_energy.monitoring.report import EnergyReport
from lta_energy.monitoring.soc_ekf import INVERSE, RESISTANCE
from lta_model.electrical.battery import BatteryModel
from lta_msgs.msg import EnergyStatus
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Illuminance
from std_msgs.msg import Bool

SECONDS_PER_HOUR = 3600.0


def to_reading(
    battery: BatteryState,
    panel: BatteryState | None,
    light: Illuminance | None,
    odom: Odometry | None,
    airspeed: TwistWithCovarianceStamped | None,
) -> MeterReading:
    """Convert the messages of the meters to a reading; NaN for those not received yet."""
    stamp = battery.header.stamp
    return MeterReading(
        stamp_ns=stamp.sec * 1_000_000_000 + stamp.nanosec,
        voltage=battery.voltage,
        current=battery.current,
        panel_voltage=math.nan if panel is None else panel.voltage,
        panel_current=math.nan if panel is None else panel.current,
        illuminance=math.nan if light is None else light.illuminance,
        where=None if odom is None else to_travel_state(odom, airspeed),
    )


def to_travel_state(
    odom: Odometry, airspeed: TwistWithCovarianceStamped | None
) -> TravelState | None:
    """
    Return distance from the start over ground, and airspeed; None while the place is unknown.

    Without an airspeed it is 0, and the usual one of the settings holds: the speed over ground
    would take a head wind for slowness.
    """
    if not has_estimate(odom.pose.covariance[0]):
        return None
    place = odom.pose.pose.position
    through_air = 0.0
    if airspeed is not None:
        speed = airspeed.twist.twist.linear
        through_air = math.hypot(speed.x, speed.y)
    return TravelState(math.hypot(place.x, place.y), through_air)


def from_charge(
    cell: BatteryModel, estimate: EnergyEstimate, measured: BatteryState
) -> BatteryState:
    """Return the measured battery with the estimated charge; REP-147 signs, NaN if unknown."""
    # sensor_msgs/BatteryState uses ampere-hours
    capacity = cell.capacity / SECONDS_PER_HOUR
    charge = estimate.charge
    return BatteryState(
        header=measured.header,
        voltage=measured.voltage,
        current=measured.current,
        temperature=math.nan,
        charge=charge * capacity,
        capacity=math.nan,  # the actual capacity is not measured
        design_capacity=capacity,
        percentage=charge,
        power_supply_status=_supply_status(measured.current),
        power_supply_health=_supply_health(estimate),
        power_supply_technology=BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO,
        present=True,
        cell_voltage=[measured.voltage],
        cell_temperature=[math.nan],
    )


def _supply_status(current: float) -> int:
    """Return the supply status for the sign of a current."""
    if current > 0.0:
        return int(BatteryState.POWER_SUPPLY_STATUS_CHARGING)
    if current < 0.0:
        return int(BatteryState.POWER_SUPPLY_STATUS_DISCHARGING)
    if current == 0.0:
        return int(BatteryState.POWER_SUPPLY_STATUS_NOT_CHARGING)
    # Only NaN passes all three comparisons
    return int(BatteryState.POWER_SUPPLY_STATUS_UNKNOWN)


def _supply_health(estimate: EnergyEstimate) -> int:
    """Return the supply health for the active faults; cell ageing is not measured."""
    if estimate.critical.on:
        return int(BatteryState.POWER_SUPPLY_HEALTH_DEAD)
    if estimate.watch.is_doubtful:
        return int(BatteryState.POWER_SUPPLY_HEALTH_UNSPEC_FAILURE)
    return int(BatteryState.POWER_SUPPLY_HEALTH_UNKNOWN)


def collect_energy_values(
    settings: MonitorSettings, aboard: PowerSystem, report: EnergyReport, reading: MeterReading
) -> dict[str, float]:
    """Return the energy balance by the fields of its message, whose comments have the units."""
    estimate, empty, full = report.estimate, report.empty, report.full
    books = estimate.books
    return {
        'power_in': reading.panel_power,
        # Load = charger output minus what charges the cell
        'power_out': aboard.charger_output(reading.panel_power) - reading.cell_power,
        'power_net': reading.cell_power,
        'harvested': books.harvested,
        'consumed': books.consumed,
        'lost': books.lost,
        'stored': books.stored,
        'imbalance': books.imbalance,
        'state_of_charge': estimate.charge,
        'state_of_charge_sigma': estimate.deviation,
        'time_to_empty': empty.mean,
        'time_to_empty_sigma': empty.deviation,
        'time_to_full': full.mean,
        'time_to_full_sigma': full.deviation,
        **_collect_cell_values(aboard.cell, estimate),
        **_collect_way_home_values(settings, estimate, reading),
        'illuminance': reading.illuminance,
    }


def _collect_cell_values(cell: BatteryModel, estimate: EnergyEstimate) -> dict[str, float]:
    """Return the estimated resistance and capacity, and the last voltage innovation."""
    if estimate.belief is None:
        resistance = capacity = math.nan
    else:
        resistance = cell.resistance * estimate.belief.mean[RESISTANCE]
        # The filter estimates a factor on the inverse of the capacity
        capacity = cell.capacity / estimate.belief.mean[INVERSE]
    surprise = estimate.surprise
    return {
        'resistance': resistance,
        'capacity': capacity,
        'innovation': math.nan if surprise is None else surprise.innovation,
    }


def _collect_way_home_values(
    settings: MonitorSettings, estimate: EnergyEstimate, reading: MeterReading
) -> dict[str, float]:
    """Return the distance home, the spare energy beyond way home and reserve, and its range."""
    stock, travel = estimate.stock, estimate.travel
    spare = math.nan if stock is None else stock.spare
    return {
        'home': math.nan if reading.where is None else reading.where.distance,
        'spare': spare,
        'reach': math.nan if travel is None else reachable_distance(settings.way, travel, spare),
    }


def from_energy_balance(
    settings: MonitorSettings,
    aboard: PowerSystem,
    report: EnergyReport,
    reading: MeterReading,
    measured: BatteryState,
) -> EnergyStatus:
    """Return energy balance and faults, with the stamp of the battery message."""
    message = EnergyStatus()
    for name, value in collect_energy_values(settings, aboard, report, reading).items():
        setattr(message, name, value)
    message.header.stamp = measured.header.stamp
    message.level, message.message = report.battery
    message.meters_level, message.meters_message = report.meters
    return message


def from_reserve(estimate: EnergyEstimate) -> Bool:
    """Return whether the reserve is reached."""
    return Bool(data=estimate.reserve)
