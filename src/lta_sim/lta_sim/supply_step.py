"""The electricity of one control period as numbers: compiled for `Supply`."""

from typing import Any, NamedTuple

from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.charger import advance_power_path, ChargerModel, PowerFlow
from lta_model.electrical.panel import find_max_power, SolarArrayModel


class SupplyParts(NamedTuple):
    """What feeds a vehicle."""

    cell: BatteryModel
    charger: ChargerModel
    array: SolarArrayModel


class SupplyInputs(NamedTuple):
    """
    What a control period brings.

    Attributes
    ----------
    irradiance : float
        On the array's plane. [W/m2]
    asked : float
        What the loads want. [W]
    dt : float
        How long it is. [s]
    shorted, cut : bool
        Whether the array is shorted, and the supply cut off, by a fault.

    """

    irradiance: float
    asked: float
    dt: float
    shorted: bool
    cut: bool


class SupplyState(NamedTuple):
    """
    How the supply stands.

    Attributes
    ----------
    flow : Flow
        Cell and powers of the last control period.
    irradiance : float
        For which the largest power stands. [W/m2]
    voltage, current : float
        The array at its largest power. [V, A]
    harvested, consumed, lost : float
        Energy since the start. [J]

    """

    flow: PowerFlow
    irradiance: float
    voltage: float
    current: float
    harvested: float
    consumed: float
    lost: float


def advance_supply(
    parts: SupplyParts,
    before: SupplyState,
    meantime: SupplyInputs,
    scratch: Any,  # noqa: ANN401
) -> SupplyState:
    """Return how the supply stands a control period later; `scratch` is not needed."""
    voltage, current = before.voltage, before.current
    if meantime.irradiance != before.irradiance:
        voltage, current = find_max_power(parts.array, meantime.irradiance)
    now, dt = before.flow, meantime.dt
    begin = PowerFlow(
        now.charge, now.relaxation, now.voltage, now.current, now.harvested, now.consumed,
        now.lost, now.fed and not meantime.cut,
    )  # fmt: skip
    available = 0.0 if meantime.shorted else voltage * current
    flow = advance_power_path(parts.cell, parts.charger, begin, available, meantime.asked, dt)
    return SupplyState(
        flow,
        meantime.irradiance,
        voltage,
        current,
        before.harvested + flow.harvested * dt,
        before.consumed + flow.consumed * dt,
        before.lost + flow.lost * dt,
    )
