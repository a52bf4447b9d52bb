"""
What a drone can know of its energy from its meters: charge, books, times, reserve, faults.

One reading goes through: what the filter expects of it, whether a detector spoils it, the filter
or, without it, a guess that the load went on as before; then books, load, way home and reserve. It
never looks at the truth.
"""

from lta_config.settings import setting
from lta_energy.faults.gap import LONGEST
from lta_energy.faults.protocol import Seen
from lta_energy.faults.watch import SWAPPED, watched
from lta_energy.monitoring import load, outlook, reserve, way_home
from lta_energy.monitoring.aboard import Aboard
from lta_energy.monitoring.belief import (
    Belief,
    BeliefSettings,
    first_look,
    look,
    predict,
    RELAXATION,
    RESISTANCE,
    Surprise,
)
from lta_energy.monitoring.books import Books, enter
from lta_energy.monitoring.estimate import Estimate
from lta_energy.monitoring.latch import Latch, latched
from lta_energy.monitoring.new_clock import ENOUGH, in_order, moved
from lta_energy.monitoring.outlook import Time
from lta_energy.monitoring.reading import Reading
from lta_energy.monitoring.reserve import ReserveSettings
from lta_energy.monitoring.way_home import WaySettings
from lta_model.electrical.battery import Battery, open_circuit_voltage

CRITICAL_VOLTAGE = 3.2  # V under load; Bitcraze's low-battery limit
RECOVERED_VOLTAGE = 3.3  # V
CRITICAL_RISE, CRITICAL_FALL = 0.3, 5.0  # s
BETWEEN = 0.3  # of a change of the current: how unsure its mean between two readings is (uniform)
EMPTY = 0.02  # of the charge at either end, where cells leave the chart
QUIET = 1e-3  # A; two counts of the meter and its offset


class MonitorSettings(ReserveSettings):
    """When to come down, and how the readings are taken."""

    smoothing: float = setting(
        5.0, 'Time constant of the power that is shown.', unit='s', low=0.0, high=600.0
    )
    outlook: float = setting(
        120.0, 'Time constant of the power in the time to empty.', unit='s', low=0.0, high=3600.0
    )
    belief: BeliefSettings = setting(BeliefSettings(), 'How far cells may differ.')
    way: WaySettings = setting(WaySettings(), 'The way home.')


def update(
    settings: MonitorSettings, aboard: Aboard, before: Estimate, reading: Reading
) -> Estimate:
    """
    Return what is known after one more reading.

    Parameters
    ----------
    settings : MonitorSettings
        The reserve and the smoothing.
    aboard : Aboard
        Cell and charger, as their file has them.
    before : Estimate
        What was known.
    reading : Reading
        The meters.

    """
    last, cell, back = before.last, aboard.cell, 0
    if last is not None and reading.stamp_ns <= last.stamp_ns:
        behind = in_order(before.behind, reading.stamp_ns)
        if len(behind) < ENOUGH:
            dt = (reading.stamp_ns - last.stamp_ns) * 1e-9
            watch = watched(before.watch, Seen(reading, last, dt, cell))
            return _decided(settings, cell, before._replace(watch=watch, behind=behind))
        back = last.stamp_ns - behind[0]
        before = moved(before, back)
        last = before.last
    dt = 0.0 if last is None else (reading.stamp_ns - last.stamp_ns) * 1e-9
    expected = _expected(settings, cell, before, reading, dt)
    seen_belief, surprise = expected, None
    if expected is not None and reading.usable:
        seen_belief, surprise = look(
            settings.belief, cell, expected, reading.voltage, reading.current
        )
    off = _surprising(expected, surprise)
    watch = watched(before.watch, Seen(reading, last, dt, cell, off, back * 1e-9))
    belief = expected if watch.spoilt else seen_belief
    another = watch.latches[SWAPPED].on and not before.watch.latches[SWAPPED].on
    if (belief is None and not watch.spoilt) or (another and reading.usable):
        belief = first_look(settings.belief, cell, reading.voltage, reading.current)
    after = before._replace(
        belief=belief, watch=watch, surprise=surprise, gap=dt, last=reading, behind=(),
        critical=_critical(before.critical, reading, dt),
    )  # fmt: skip
    if not watch.spoilt:
        after = _counted(settings, aboard, after, reading, dt)
    return _decided(settings, cell, after)


def _expected(
    settings: MonitorSettings, cell: Battery, before: Estimate, reading: Reading, dt: float
) -> Belief | None:
    """Return what is believed of the cell before the newest voltage is looked at."""
    belief = before.belief
    if belief is None or before.good is None:
        return belief
    current, unsure = _blind_current(before, belief)
    if before.good is before.last and reading.usable and dt <= LONGEST:
        current = 0.5 * (before.good.current + reading.current)
        unsure = BETWEEN * abs(reading.current - before.good.current) + QUIET
    return predict(settings.belief, cell, belief, current, unsure, dt)


def _surprising(expected: Belief | None, surprise: Surprise | None) -> float:
    """Return by how many deviations a voltage was off; beyond the ends of the chart by none."""
    if expected is None or surprise is None:
        return 0.0
    end = EMPTY if surprise.innovation < 0.0 else 1.0 - EMPTY
    beyond = expected.charge < end if surprise.innovation < 0.0 else expected.charge > end
    return 0.0 if beyond else abs(surprise.innovation) / surprise.deviation


def _blind_current(before: Estimate, belief: Belief) -> tuple[float, float]:
    """Return the current to expect while no reading tells, and how unsure that is. [A]"""
    current = -before.load.quick / open_circuit_voltage(belief.charge)
    return current, abs(current) + QUIET


def _critical(before: Latch, reading: Reading, dt: float) -> Latch:
    """Return whether the voltage is critical; it must recover before that is taken back."""
    if not reading.usable:
        return before
    limit = RECOVERED_VOLTAGE if before.on else CRITICAL_VOLTAGE
    return latched(before, reading.voltage <= limit, dt, CRITICAL_RISE, CRITICAL_FALL)


def _counted(
    settings: MonitorSettings, aboard: Aboard, after: Estimate, reading: Reading, dt: float
) -> Estimate:
    """Return the estimate with a good reading in load, books and way."""
    belief = after.belief
    if belief is None:
        return after
    power = -open_circuit_voltage(belief.charge) * reading.current
    if after.good is None or after.travel is None:
        return after._replace(
            load=load.first(power), travel=way_home.begun(settings.way), good=reading
        )
    return after._replace(
        load=load.smoothed(after.load, power, dt, settings.smoothing, settings.outlook),
        travel=way_home.seen(settings.way, after.travel, reading.where, power, dt),
        books=_entered(after.books, aboard, belief, after.good, reading),
        good=reading,
    )


def _entered(
    books: Books, aboard: Aboard, belief: Belief, last: Reading, reading: Reading
) -> Books:
    """
    Return the books after the time between two good readings.

    Stored is what flowed into the chemistry by the current and the resting voltage, lost what
    charger and resistances turned into heat; what is left over says how far model and meters
    disagree.
    """
    dt = (reading.stamp_ns - last.stamp_ns) * 1e-9
    current = 0.5 * (last.current + reading.current)
    squared = 0.5 * (last.current**2 + reading.current**2)
    harvest = 0.5 * (last.income + reading.income)
    given = 0.5 * (aboard.given(last.harvest) + aboard.given(reading.harvest))
    return enter(
        books,
        harvest=harvest,
        load=given - 0.5 * (last.power + reading.power),
        loss=harvest
        - given
        + belief.mean[RESISTANCE] * aboard.cell.resistance * squared
        + belief.mean[RELAXATION] * current,
        stored=open_circuit_voltage(belief.charge) * current * dt,
        dt=dt,
    )


def _decided(settings: MonitorSettings, cell: Battery, after: Estimate) -> Estimate:
    """Return the estimate with the decision about the reserve."""
    belief, travel = after.belief, after.travel
    if belief is None or travel is None:
        return after
    where = None if after.last is None else after.last.where
    away = 0.0 if where is None else where.distance
    stock = reserve.stock(settings, cell, belief, way_home.energy_home(settings.way, travel, away))
    low = reserve.reached(settings, after.low, stock)
    doubtful = belief.deviation > settings.doubt
    return after._replace(stock=stock, low=low, reserve=low or doubtful or after.urgent)


def time_to_empty(settings: MonitorSettings, cell: Battery, estimate: Estimate) -> Time:
    """Return how long the charge lasts at the mean load; infinite while nothing is drained."""
    if estimate.belief is None:
        return outlook.UNKNOWN
    spread = load.deviation(estimate.load, settings.smoothing, settings.outlook)
    return outlook.to_empty(cell, estimate.belief, estimate.load.mean, spread)


def time_to_full(settings: MonitorSettings, cell: Battery, estimate: Estimate) -> Time:
    """Return how long the cell takes until it is full; infinite while it is not charged."""
    if estimate.belief is None:
        return outlook.UNKNOWN
    spread = load.deviation(estimate.load, settings.smoothing, settings.outlook)
    return outlook.to_full(cell, estimate.belief, estimate.load.mean, spread)
