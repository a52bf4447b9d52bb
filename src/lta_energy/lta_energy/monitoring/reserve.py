"""Decide when to land: compare the lower bound of the charge with the reserve."""

from typing import NamedTuple

from lta_config.settings import setting, Settings
from lta_energy.monitoring.endurance import energy_between
from lta_energy.monitoring.soc_ekf import CellState, INVERSE
from lta_model.electrical.battery import BatteryModel


class EnergyReserveSettings(Settings):
    """Energy reserve that the drone must keep."""

    reserve: float = setting(
        0.25, 'State of charge (0 to 1) at which the energy reserve is reached.', low=0.0, high=0.9
    )
    hysteresis: float = setting(
        0.05,
        'Rise of the state of charge above the reserve at which the alarm clears.',
        low=0.0,
        high=0.1,
    )
    caution: float = setting(
        1.0,
        'Safety margin subtracted from the state of charge, in standard deviations of its '
        'estimate.',
        low=0.0,
        high=5.0,
    )
    doubt: float = setting(
        0.15,
        'Standard deviation above which the state of charge is reported as unreliable.',
        low=0.01,
        high=0.3,
    )


class ReserveMargin(NamedTuple):
    """Charge compared with the reserve."""

    sure: float  # lower bound of the charge [1]
    home: float  # charge needed for the way home [1]
    spare: float  # energy beyond reserve and way home; negative if it is missing [J]


def compute_reserve_margin(
    settings: EnergyReserveSettings, cell: BatteryModel, state: CellState, home: float
) -> ReserveMargin:
    """Compare the charge with the reserve and the energy of the way home. [J]"""
    sure = state.charge - settings.caution * state.deviation
    # Energy per unit of charge at the present voltage [J]
    full = state.resting_voltage * cell.capacity / state.mean[INVERSE]
    return ReserveMargin(
        sure, home / full, energy_between(cell, state, settings.reserve, max(sure, 0.0)) - home
    )


def is_reserve_reached(
    settings: EnergyReserveSettings, before: bool, stock: ReserveMargin
) -> bool:
    """Return whether the reserve is reached, with hysteresis."""
    # Once reached, the charge must rise by the hysteresis before the alarm clears
    return stock.sure <= settings.reserve + stock.home + (settings.hysteresis if before else 0.0)
