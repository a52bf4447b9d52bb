"""Energy cores to ROS messages and back."""

import math

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from lta_energy.monitoring import alarms
from lta_energy.monitoring.aboard import Aboard
from lta_energy.monitoring.belief import INVERSE, RESISTANCE
from lta_energy.monitoring.estimate import Estimate
from lta_energy.monitoring.monitor import MonitorSettings, time_to_empty, time_to_full
from lta_energy.monitoring.reading import Reading, Whereabouts
from lta_energy.monitoring.way_home import reach
from lta_graph.ros.sound import fault
from lta_model.electrical.battery import Battery
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Illuminance
from std_msgs.msg import Bool

SECONDS_PER_HOUR = 3600.0
UNKNOWN = -1.0  # in the first element of a covariance: the estimator is still learning


def to_reading(
    battery: BatteryState,
    panel: BatteryState | None,
    light: Illuminance | None,
    odom: Odometry | None,
) -> Reading:
    """Return the meters' messages as a reading; NaN where no message has come yet."""
    stamp = battery.header.stamp
    return Reading(
        stamp_ns=stamp.sec * 1_000_000_000 + stamp.nanosec,
        voltage=battery.voltage,
        current=battery.current,
        panel_voltage=math.nan if panel is None else panel.voltage,
        panel_current=math.nan if panel is None else panel.current,
        illuminance=math.nan if light is None else light.illuminance,
        where=None if odom is None else to_whereabouts(odom),
    )


def to_whereabouts(odom: Odometry) -> Whereabouts | None:
    """Return distance from the start and speed; None while the estimator is learning or fails."""
    if odom.pose.covariance[0] == UNKNOWN or fault(odom):
        return None
    place, speed = odom.pose.pose.position, odom.twist.twist.linear
    return Whereabouts(math.hypot(place.x, place.y), math.hypot(speed.x, speed.y))


def from_charge(cell: Battery, estimate: Estimate, measured: BatteryState) -> BatteryState:
    """Return the measured battery with the estimated charge; REP-147 signs, NaN if unknown."""
    capacity = cell.capacity / SECONDS_PER_HOUR
    return BatteryState(
        header=measured.header,
        voltage=measured.voltage,
        current=measured.current,
        temperature=math.nan,
        charge=estimate.charge * capacity,
        capacity=math.nan,  # of this very cell nobody measured it
        design_capacity=capacity,
        percentage=estimate.charge,
        power_supply_status=_flow(measured.current),
        power_supply_health=_health(estimate),
        power_supply_technology=BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO,
        present=True,
        cell_voltage=[measured.voltage],
        cell_temperature=[math.nan],
    )


def _flow(current: float) -> int:
    """Return the supply status that a current means."""
    if current > 0.0:
        return int(BatteryState.POWER_SUPPLY_STATUS_CHARGING)
    if current < 0.0:
        return int(BatteryState.POWER_SUPPLY_STATUS_DISCHARGING)
    if current == 0.0:
        return int(BatteryState.POWER_SUPPLY_STATUS_NOT_CHARGING)
    return int(BatteryState.POWER_SUPPLY_STATUS_UNKNOWN)


def _health(estimate: Estimate) -> int:
    """Return the health that the faults mean; nobody measures more of it."""
    if estimate.critical.on:
        return int(BatteryState.POWER_SUPPLY_HEALTH_DEAD)
    if estimate.watch.doubtful:
        return int(BatteryState.POWER_SUPPLY_HEALTH_UNSPEC_FAILURE)
    return int(BatteryState.POWER_SUPPLY_HEALTH_UNKNOWN)


def figures(
    settings: MonitorSettings, aboard: Aboard, estimate: Estimate, reading: Reading
) -> dict[str, float]:
    """Return the books as named numbers; each name ends with its unit."""
    books, cell = estimate.books, aboard.cell
    empty = time_to_empty(settings, cell, estimate)
    full = time_to_full(settings, cell, estimate)
    return {
        'power_in_W': reading.harvest,
        'power_out_W': aboard.given(reading.harvest) - reading.power,
        'power_net_W': reading.power,
        'harvested_J': books.harvested,
        'consumed_J': books.consumed,
        'lost_J': books.lost,
        'stored_J': books.stored,
        'imbalance_J': books.imbalance,
        'state_of_charge_1': estimate.charge,
        'state_of_charge_sigma_1': estimate.deviation,
        'time_to_empty_s': empty.mean,
        'time_to_empty_sigma_s': empty.deviation,
        'time_to_full_s': full.mean,
        'time_to_full_sigma_s': full.deviation,
        **_of_cell(cell, estimate),
        **_of_way(settings, estimate, reading),
        'illuminance_lx': reading.illuminance,
    }


def _of_cell(cell: Battery, estimate: Estimate) -> dict[str, float]:
    """Return what the filter makes of the cell itself, and how far off its last voltage was."""
    if estimate.belief is None:
        resistance = capacity = math.nan
    else:
        resistance = cell.resistance * estimate.belief.mean[RESISTANCE]
        capacity = cell.capacity / estimate.belief.mean[INVERSE]
    surprise = estimate.surprise
    return {
        'resistance_ohm': resistance,
        'capacity_C': capacity,
        'innovation_V': math.nan if surprise is None else surprise.innovation,
    }


def _of_way(settings: MonitorSettings, estimate: Estimate, reading: Reading) -> dict[str, float]:
    """Return how far home is, what is left beyond it and the reserve, and how far that brings."""
    stock, travel = estimate.stock, estimate.travel
    spare = math.nan if stock is None else stock.spare
    return {
        'home_m': math.nan if reading.where is None else reading.where.distance,
        'spare_J': spare,
        'reach_m': math.nan if travel is None else reach(settings.way, travel, spare),
    }


def from_books(
    settings: MonitorSettings,
    aboard: Aboard,
    estimate: Estimate,
    reading: Reading,
    measured: BatteryState,
) -> DiagnosticArray:
    """Return books and faults as two diagnostic statuses, stamped as the battery was measured."""
    level, sentence = alarms.battery(settings, aboard.cell, estimate)
    trust, faults = alarms.meters(estimate)
    numbers = figures(settings, aboard, estimate, reading)
    array = DiagnosticArray()
    array.header.stamp = measured.header.stamp
    array.status = [
        DiagnosticStatus(
            level=bytes([level]),
            name='energy',
            message=sentence,
            values=[KeyValue(key=key, value=f'{value:.9g}') for key, value in numbers.items()],
        ),
        DiagnosticStatus(level=bytes([trust]), name='meters', message=faults),
    ]
    return array


def from_reserve(estimate: Estimate) -> Bool:
    """Return whether the reserve is reached."""
    return Bool(data=estimate.reserve)
