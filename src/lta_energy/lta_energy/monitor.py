"""
What a drone can know of its energy from its meters: charge, books, time to empty, reserve.

The state of charge starts from the first voltage, corrected for the drop over the resistance, and
then follows the current alone (coulomb counting, trapezoidal). It never looks at the truth.
"""

from dataclasses import dataclass, replace
import math
from typing import final

from lta_config.settings import setting, Settings
from lta_energy.battery import (
    Battery,
    count,
    open_circuit_voltage,
    state_of_charge,
    stored_energy,
)
from lta_energy.books import Books, enter


class MonitorSettings(Settings):
    """When to come down, and how the readings are taken."""

    reserve: float = setting(
        0.25, 'State of charge at which the reserve is reached.', low=0.0, high=0.9
    )
    hysteresis: float = setting(
        0.05, 'Charge above the reserve that takes the alarm back.', low=0.0, high=0.1
    )
    smoothing: float = setting(
        5.0, 'Time constant of the power in the time to empty.', unit='s', low=0.0, high=600.0
    )
    rest_current: float = setting(
        0.1, 'Largest current at which a cell counts as resting.', unit='A', low=0.0, high=10.0
    )


@final
@dataclass(frozen=True, slots=True)
class Reading:
    """
    One turn of the meters; NaN is what is not measured.

    Attributes
    ----------
    stamp_ns : int
        When. [ns]
    voltage, current : float
        Cell; a positive current charges. [V, A]
    harvest : float
        Power of the panel. [W]
    illuminance : float
        Light at the panel. [lx]

    """

    stamp_ns: int
    voltage: float
    current: float
    harvest: float = math.nan
    illuminance: float = math.nan

    @property
    def usable(self) -> bool:
        """Whether the cell's voltage and current are numbers; the charge needs no more."""
        return math.isfinite(self.voltage) and math.isfinite(self.current)

    @property
    def income(self) -> float:
        """Power of the panel as the books take it: 0 where it is not measured. [W]"""
        return self.harvest if math.isfinite(self.harvest) else 0.0

    @property
    def power(self) -> float:
        """Power into the cell at its terminals. [W]"""
        return self.voltage * self.current


@final
@dataclass(frozen=True, slots=True)
class Estimate:
    """
    What is known after a reading.

    Attributes
    ----------
    charge : float
        State of charge, NaN before the first usable reading. [1]
    drain : float
        Smoothed power that leaves the cell's chemistry, losses included. [W]
    reserve : bool
        Whether the reserve is reached; an unknown charge counts as reached.
    rested : bool
        Whether the first voltage was that of a resting cell.
    gap : float
        Time since the reading before. [s]
    last : Reading or None
        The last usable reading.
    books : Books
        Energy since the first usable reading.

    """

    charge: float = math.nan
    drain: float = 0.0
    reserve: bool = True
    rested: bool = False
    gap: float = 0.0
    last: Reading | None = None
    books: Books = Books()  # noqa: RUF009 - frozen


def update(
    settings: MonitorSettings, cell: Battery, before: Estimate, reading: Reading
) -> Estimate:
    """
    Return what is known after one more reading; an unusable or older one changes nothing.

    Parameters
    ----------
    settings : MonitorSettings
        The reserve and the smoothing.
    cell : Battery
        The cell, as the monitor believes it to be.
    before : Estimate
        What was known.
    reading : Reading
        The meters.

    """
    if not reading.usable:
        return before
    if before.last is None:
        return _begin(settings, cell, reading)
    dt = (reading.stamp_ns - before.last.stamp_ns) * 1e-9
    if dt <= 0.0:
        return before
    last = before.last
    charge = count(before.charge, 0.5 * (last.current + reading.current), cell.capacity, dt)
    harvest = 0.5 * (last.income + reading.income)
    books = enter(
        before.books,
        harvest=harvest,
        load=harvest - 0.5 * (last.power + reading.power),
        loss=0.5 * cell.resistance * (last.current**2 + reading.current**2),
        stored=stored_energy(charge, cell.capacity) - stored_energy(before.charge, cell.capacity),
        dt=dt,
    )
    weight = -math.expm1(-dt / settings.smoothing) if settings.smoothing else 1.0
    drain = before.drain + weight * (_drain(charge, reading) - before.drain)
    reserve = _reserve(settings, before.reserve, charge)
    return replace(
        before, charge=charge, drain=drain, reserve=reserve, gap=dt, last=reading, books=books
    )


def _begin(settings: MonitorSettings, cell: Battery, reading: Reading) -> Estimate:
    """Return the estimate of a first reading: the charge by the resting voltage."""
    charge = state_of_charge(reading.voltage - cell.resistance * reading.current)
    return Estimate(
        charge=charge,
        drain=_drain(charge, reading),
        reserve=_reserve(settings, False, charge),
        rested=abs(reading.current) <= settings.rest_current,
        last=reading,
    )


def _drain(charge: float, reading: Reading) -> float:
    return -open_circuit_voltage(charge) * reading.current


def _reserve(settings: MonitorSettings, before: bool, charge: float) -> bool:
    """Tell whether the reserve is reached, with hysteresis."""
    return charge <= settings.reserve + (settings.hysteresis if before else 0.0)


def time_to_empty(cell: Battery, estimate: Estimate) -> float:
    """
    Return how long the charge lasts at the smoothed drain. [s]

    Returns
    -------
    float
        Infinite while nothing is drained; NaN before the first usable reading.

    """
    if math.isnan(estimate.charge):
        return math.nan
    if estimate.drain <= 0.0:
        return math.inf
    return stored_energy(estimate.charge, cell.capacity) / estimate.drain
