"""
When to fly: the naive duty cycle, and one that reckons with light, charge and the night.

A schedule is a plain function of what the drone can know. Both ask `safe` before a take-off, so
that they differ in when they fly, not in what they dare.
"""

from collections.abc import Callable
import math
from typing import NamedTuple

from lta_config.schema.light_day_file import DAY
from lta_energy.gauge import Gauge
from lta_energy.light_of_days import Light, LightOfDays
from lta_model.electrical.battery import Battery, stored_energy

SURE = 2.0  # standard deviations of charge and of a flight's need that a take-off allows for
LOOK = 300.0  # s between two looks of the energy-aware schedule while it waits
STEP = 600.0  # s of the forecast
NIGHT = 1.3  # of the energy that the night is reckoned to take, so much is kept for it


class Known(NamedTuple):
    """
    What a schedule may look at.

    Attributes
    ----------
    time : float
        Since the first midnight. [s]
    gauge : Gauge
        Charge as the drone knows it.
    cell : Battery
        As the drone believes it.
    income : callable
        What the charger can give in some light. [W]
    light : LightOfDays
        Of which only `expected` is looked at.
    seen : float
        Light by what was to be expected, over the last hour by day. [1]
    awake, asleep : float
        What is drawn on the perch. [W]
    work : tuple of float
        Times of the day between which it may fly. [s]
    reserve : float
        State of charge that a flight must leave.
    need, spread : float
        Energy of a flight, as flown so far, and its standard deviation. [J]
    flight : float
        How long one lasts. [s]
    landed, lasted : float
        When the last flight ended, and how long it was; `landed` is -inf before the first. [s]

    """

    time: float
    gauge: Gauge
    cell: Battery
    income: Callable[[Light], float]
    light: LightOfDays
    seen: float
    awake: float
    asleep: float
    work: tuple[float, float]
    reserve: float
    need: float
    spread: float
    flight: float
    landed: float
    lasted: float


class Wish(NamedTuple):
    """What to do next: fly, or rest until a time, asleep or awake."""

    fly: bool
    until: float = 0.0
    asleep: bool = False


Schedule = Callable[[Known], Wish]


def at_work(known: Known) -> bool:
    """Tell whether a flight that starts now is back within the hours of work."""
    clock = known.time % DAY
    begin, end = known.work
    if begin <= end:
        return begin <= clock and clock + 1.5 * known.flight <= end
    return clock >= begin or clock + 1.5 * known.flight <= end


def begins(known: Known) -> float:
    """Return when work begins next. [s]"""
    today = known.time - known.time % DAY + known.work[0]
    return today if today > known.time else today + DAY


def ends(known: Known) -> float:
    """Return when work ends next. [s]"""
    today = known.time - known.time % DAY + known.work[1]
    return today if today >= known.time else today + DAY


def least(known: Known) -> float:
    """Return the energy that a cell which is surely above the reserve holds. [J]"""
    sure = known.reserve + SURE * known.gauge.deviation
    return stored_energy(min(sure, 1.0), known.cell.capacity)


def holds(known: Known) -> float:
    """Return what the cell holds, as the drone knows it. [J]"""
    return stored_energy(known.gauge.charge, known.cell.capacity)


def safe(known: Known) -> bool:
    """Tell whether the charge suffices for a flight."""
    return holds(known) - known.need - SURE * known.spread >= least(known)


def fixed(rest: float, *, asleep: bool = False) -> Schedule:
    """Return the naive schedule: rest so many times the flight [1], awake in the hours of work."""

    def schedule(known: Known) -> Wish:
        if not at_work(known):
            return Wish(False, begins(known), True)
        ready = known.landed + rest * known.lasted
        if known.time < ready:
            return Wish(False, ready, asleep)
        return Wish(True) if safe(known) else Wish(False, known.time + LOOK, asleep)

    return schedule


def by_light(known: Known) -> Wish:
    """
    Return what the energy-aware schedule wants.

    It flies when the charge is safe and either the night is provided for without what the flight
    takes, or the cell would be full before dark and light be wasted. Otherwise it sleeps.
    """
    if not at_work(known):
        return Wish(False, begins(known), True)
    if not safe(known):
        return Wish(False, known.time + LOOK, True)
    full, dusk = outlook(known)
    if full or dusk - known.need >= night(known):
        return Wish(True)
    return Wish(False, known.time + LOOK, True)


def outlook(known: Known) -> tuple[bool, float]:
    """Tell whether the cell would be full by the end of work, and what it would hold then. [J]"""
    energy, most = holds(known), stored_energy(1.0, known.cell.capacity)
    full, time = False, known.time
    # Not `at_work` of each step: a break shorter than a step is stepped over, and work never ends.
    last = ends(known) - 1.5 * known.flight
    while time <= last:
        energy += (coming(known, time) - known.asleep) * STEP
        if energy >= most:
            full, energy = True, most
        time += STEP
    return full, energy


def night(known: Known) -> float:
    """Return what the cell must hold at the end of work to reach the next morning. [J]"""
    time = ends(known)
    end, needed, taken = time + DAY, 0.0, 0.0
    while time < end and coming(known, time) < known.asleep:
        taken += (known.asleep - coming(known, time)) * STEP
        needed = max(needed, taken)
        time += STEP
    return least(known) + NIGHT * needed


def coming(known: Known, time: float) -> float:
    """Return the harvest that is to be expected at a time, as cloudy as it is now. [W]"""
    light = known.light.expected(time)
    # The sky as it is now says little about the sky in some hours.
    weight = math.exp(-(time - known.time) / 7200.0)
    seen = 1.0 + weight * (known.seen - 1.0)
    return known.income(light._replace(sun=seen * light.sun))
