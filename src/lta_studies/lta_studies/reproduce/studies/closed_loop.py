"""Closed loop against the open-loop baseline, and the baseline's model under our controller."""

from typing import Final

from lta_config.typed import typed
from lta_studies.reproduce.found import Asked, Found, Picture, Value
from lta_studies.reproduce.manoeuvres import fly

FLOWN: Final = {
    'gtmab': ('climb', 'cruise'),
    'blimp2b': ('climb', 'cruise'),
    'blimp2b_cascade': ('climb', 'cruise'),
    'gtmab_open_loop': ('climb', 'cruise'),
}
QUICK: Final = ('gtmab', 'blimp2b')
CAPTIONS: Final = {
    'climb': 'Rise by 1.5 m and hold that. Asked dashed; flights of seed 1.',
    'cruise': 'Rise, then fly at 0.5 m/s: speed along the course. Asked dashed; seed 1.',
}
HEADINGS: Final = {'climb': 'Altitude task', 'cruise': 'Velocity task'}


def study(asked: Asked) -> Found:
    """Return both models, each by both ways to command them."""
    shown = QUICK if asked.quick else tuple(FLOWN)
    pairs = [(name, each) for name in shown for each in FLOWN[name]]
    flights = fly(pairs, asked.seeds)
    values: dict[str, Value] = {}
    for name, manoeuvre in pairs:
        values[f'{name}_{manoeuvre}_held'] = flights.held(name, manoeuvre)
        values[f'{name}_{manoeuvre}_overshoot'] = flights.value(name, manoeuvre, 'overshoot')
        values[f'{name}_{manoeuvre}_rms'] = flights.value(name, manoeuvre, 'rms')
    for name in shown:
        values[f'{name}_climb_settles'] = flights.value(name, 'climb', 'settling_time')
        values[f'{name}_cruise_ripple'] = flights.value(name, 'cruise', 'ripple')
    pictures = [
        Picture(each, HEADINGS[each], CAPTIONS[each], flights.picture(each, shown),
                typed('platforms', '--seeds', str(asked.seeds)),
                '' if asked.quick else flights.record(each, shown, asked.folder / each))
        for each in CAPTIONS
    ]  # fmt: skip
    return Found(values, pictures)
