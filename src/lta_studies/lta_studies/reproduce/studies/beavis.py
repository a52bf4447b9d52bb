"""BEAVIS against GT-MAB, both 2 g heavy: altitude, yaw hold, changing yaw."""

from typing import Final

from lta_config.constants import AIR_DENSITY, STANDARD_GRAVITY
from lta_config.typed import typed
from lta_studies.platforms.entries import entrant
from lta_studies.platforms.summary import margin
from lta_studies.reproduce.found import Asked, Found, Picture, Value
from lta_studies.reproduce.manoeuvres import Flights, fly

MANOEUVRES: Final = ('climb', 'turn', 'follow')
BOTH: Final = ('gtmab', 'beavis_paper')
CHANGED: Final = {
    'beavis': MANOEUVRES,
    'beavis_by_matrix': ('climb', 'turn'),
    'beavis_uncompensated': MANOEUVRES,
    'beavis_too_heavy': ('climb',),
}
CAPTIONS: Final = {
    'climb': 'Rise by 1.5 m and hold that: asked dashed, flights of seed 1.',
    'turn': 'Rise, then turn left by 90° and hold that: asked dashed, flights of seed 1.',
    'follow': 'Rise, then follow a heading that swings between 0 and 90° at 6°/s; seed 1.',
}
HEADINGS: Final = {
    'climb': 'Altitude', 'turn': 'Yaw angle', 'follow': 'Continuously changing yaw',
}  # fmt: skip


def study(asked: Asked) -> Found:
    """Return both platforms in the paper's tasks, and what decides over BEAVIS."""
    manoeuvres = MANOEUVRES[:2] if asked.quick else MANOEUVRES
    pairs = [(name, each) for name in BOTH for each in manoeuvres]
    if not asked.quick:
        pairs += [(name, each) for name, own in CHANGED.items() for each in own]
    flights = fly(pairs, asked.seeds)
    values: dict[str, Value] = {}
    for name, manoeuvre in pairs:
        values[f'{name}_{manoeuvre}_held'] = flights.held(name, manoeuvre)
        values[f'{name}_{manoeuvre}_rms'] = flights.value(name, manoeuvre, 'rms')
    values['gtmab_overshoot'] = flights.value('gtmab', 'climb', 'overshoot')
    values['gtmab_settles'] = flights.value('gtmab', 'climb', 'settling_time')
    values |= margins(flights)
    return Found(values, [picture(asked, flights, each) for each in manoeuvres])


def picture(asked: Asked, flights: Flights, manoeuvre: str) -> Picture:
    """Return both platforms in a manoeuvre, and BEAVIS by a linear B where that was flown."""
    names = BOTH if asked.quick or manoeuvre == 'follow' else (*BOTH, 'beavis_by_matrix')
    bag = '' if asked.quick else flights.record(manoeuvre, names, asked.folder / manoeuvre)
    return Picture(
        manoeuvre, HEADINGS[manoeuvre], CAPTIONS[manoeuvre], flights.picture(manoeuvre, names),
        typed('platforms', '--seeds', str(asked.seeds)), bag,
    )  # fmt: skip


def margins(flights: Flights) -> dict[str, Value]:
    """Return what the rotors lift at full thrust beyond the weight, as mass. [kg]"""
    values = {}
    for name in (*BOTH, 'beavis'):
        vehicle = entrant(flights.comparison.contestants[name], AIR_DENSITY).vehicle
        lift, weight = margin(vehicle)
        values[f'{name}_lift'] = Value(lift)
        values[f'{name}_margin'] = Value((lift - weight) / STANDARD_GRAVITY)
    return values
