"""Advance the electric supply by one control period; compiled for `Supply`."""

from typing import Any, NamedTuple

from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.charger import advance_power_path, ChargerModel, PowerFlow
from lta_model.electrical.panel import find_max_power_point, SolarArrayModel


class SupplyComponents(NamedTuple):
    """Components of the supply."""

    cell: BatteryModel
    charger: ChargerModel
    array: SolarArrayModel


class SupplyInputs(NamedTuple):
    """Inputs of one control period."""

    irradiance: float
    demand: float
    dt: float
    shorted: bool
    cut: bool


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
    parts: SupplyComponents,
    before: SupplyState,
    meantime: SupplyInputs,
    scratch: Any,  # noqa: ANN401
) -> SupplyState:
    """Return the supply's state one control period later; `scratch` is not needed."""
    voltage, current = before.voltage, before.current
    # The search for the maximum power point is slow; light is updated less often than loads
    if meantime.irradiance != before.irradiance:
        voltage, current = find_max_power_point(parts.array, meantime.irradiance)
    now, dt = before.flow, meantime.dt
    begin = PowerFlow(
        now.charge, now.relaxation, now.voltage, now.current, now.harvested, now.consumed,
        # An injected fault cuts the supply as a brown-out does
        now.lost, now.fed and not meantime.cut,
    )  # fmt: skip
    available = 0.0 if meantime.shorted else voltage * current
    flow = advance_power_path(parts.cell, parts.charger, begin, available, meantime.demand, dt)
    return SupplyState(
        flow,
        meantime.irradiance,
        voltage,
        current,
        before.harvested + flow.harvested * dt,
        before.consumed + flow.consumed * dt,
        before.lost + flow.lost * dt,
    )
