"""Energy cores to ROS messages and back."""

import math

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from lta_energy.battery import Battery
from lta_energy.monitor import Estimate, Reading, time_to_empty
from lta_graph.health import Level
from sensor_msgs.msg import BatteryState, Illuminance
from std_msgs.msg import Bool

SECONDS_PER_HOUR = 3600.0


def to_reading(
    battery: BatteryState, panel: BatteryState | None, light: Illuminance | None
) -> Reading:
    """Return the meters' messages as a reading; NaN where no message has come yet."""
    stamp = battery.header.stamp
    return Reading(
        stamp_ns=stamp.sec * 1_000_000_000 + stamp.nanosec,
        voltage=battery.voltage,
        current=battery.current,
        harvest=math.nan if panel is None else panel.voltage * panel.current,
        illuminance=math.nan if light is None else light.illuminance,
    )


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
        power_supply_health=BatteryState.POWER_SUPPLY_HEALTH_UNKNOWN,
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


def figures(cell: Battery, estimate: Estimate, reading: Reading) -> dict[str, float]:
    """Return the books as named numbers; each name ends with its unit."""
    books = estimate.books
    return {
        'power_in_W': reading.harvest,
        'power_out_W': reading.income - reading.power,
        'power_net_W': reading.power,
        'harvested_J': books.harvested,
        'consumed_J': books.consumed,
        'lost_J': books.lost,
        'stored_J': books.stored,
        'imbalance_J': books.imbalance,
        'state_of_charge_1': estimate.charge,
        'time_to_empty_s': time_to_empty(cell, estimate),
        'illuminance_lx': reading.illuminance,
    }


def from_books(
    cell: Battery,
    estimate: Estimate,
    reading: Reading,
    verdict: tuple[Level, str],
    measured: BatteryState,
) -> DiagnosticArray:
    """Return the books as one diagnostic status, stamped as the battery was measured."""
    level, sentence = verdict
    numbers = figures(cell, estimate, reading)
    array = DiagnosticArray()
    array.header.stamp = measured.header.stamp
    array.status = [
        DiagnosticStatus(
            level=bytes([level]),
            name='energy',
            message=sentence,
            values=[KeyValue(key=key, value=f'{value:.9g}') for key, value in numbers.items()],
        )
    ]
    return array


def from_reserve(estimate: Estimate) -> Bool:
    """Return whether the reserve is reached."""
    return Bool(data=estimate.reserve)
