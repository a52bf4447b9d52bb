"""Advance the electric supply by one control period; compiled for `Supply` and for batches."""

from typing import Any, NamedTuple

from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.charger import advance_power_path, ChargerModel, PowerFlow
from lta_model.electrical.loads import LoadModel, power_demand
from lta_model.electrical.panel import find_max_power_point, SolarArrayModel
from lta_model.scenario import FaultTimes, is_cut_off, is_shorted

Thrusts = tuple[float, float, float, float, float, float, float, float]  # zero in unused slots


class SupplyComponents(NamedTuple):
    """Components of the supply."""

    cell: BatteryModel
    charger: ChargerModel
    array: SolarArrayModel


class SupplyConstants(NamedTuple):
    """What determines the supply of a flight, except its light and its thrusts."""

    parts: SupplyComponents
    loads: LoadModel
    navigation: float  # power of light sensing and computing [W]
    faults: FaultTimes


class SupplyInputs(NamedTuple):
    """Inputs of one control period."""

    irradiance: float  # on the array [W/m2]
    thrusts: Thrusts  # [N]
    payload: float  # [W]
    step: float  # number of the period, from 0
    dt: float  # [s]


class SupplyState(NamedTuple):
    """State of the supply."""

    flow: PowerFlow
    irradiance: float
    voltage: float
    current: float
    harvested: float
    consumed: float
    lost: float


def advance_supply(
    constants: SupplyConstants,
    before: SupplyState,
    meantime: SupplyInputs,
    scratch: Any,  # noqa: ANN401
) -> SupplyState:
    """Return the supply's state one control period later; `scratch` is not needed."""
    parts, faults, dt = constants.parts, constants.faults, meantime.dt
    # Products and no sums, whose rounding would move a fault by a period
    begun, ended = meantime.step * dt, (meantime.step + 1.0) * dt
    demand = power_demand(constants.loads, meantime.thrusts, True) + constants.navigation
    demand += meantime.payload
    voltage, current = before.voltage, before.current
    # The search for the maximum power point is slow; light is updated less often than loads
    if meantime.irradiance != before.irradiance:
        voltage, current = find_max_power_point(parts.array, meantime.irradiance)
    now = before.flow
    begin = PowerFlow(
        now.charge, now.relaxation, now.voltage, now.current, now.harvested, now.consumed,
        # An injected fault cuts the supply as a brown-out does
        now.lost, now.fed and not is_cut_off(faults, begun, ended),
    )  # fmt: skip
    available = 0.0 if is_shorted(faults, begun) else voltage * current
    flow = advance_power_path(parts.cell, parts.charger, begin, available, demand, dt)
    return SupplyState(
        flow,
        meantime.irradiance,
        voltage,
        current,
        before.harvested + flow.harvested * dt,
        before.consumed + flow.consumed * dt,
        before.lost + flow.lost * dt,
    )
