# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The results that pages quote are the stored ones.

A quote is a piece of a page with stored values in braces. If a result changes on purpose, its
command stores the new one, this test fails, and the page has to follow:

- test/golden/paper_full.json: `./lta reproduce`
- test/same/frozen/commands.csv: `make same ARGS=--freeze`
- test/golden/mission_summer.json: `./lta mission greenhouse_summer --seeds 5 --json`, less `page`
"""

import csv
import json
import math
from pathlib import Path
import re

from lta_flight.sweep.statistics import bootstrap_mean
from lta_report.result_table import format_value
import pytest

ROOT = Path(__file__).resolve().parents[2]
GOLDEN = ROOT / 'test/golden'
# Of the seed paper: hovering, and the middle of what it prints for the strategies. [mW]
HOVER, NAVIGATE = 1333.0, 1533.5
QUOTES = {
    'docs/energy_budget.md': (
        'take-off, 4.6 s to half a metre | {take_off:.0f} mW |',
        'hovering | {hover:.0f} mW | 1333 mW | {hover_ratio:.2f} of it |',
        'flying at 0.5 m/s | {fly:.0f} mW |',
        'navigating, BAG, DES, DGA | {bag:.0f}, {des:.0f}, {dga:.0f} mW |'
        ' 1523 to 1544 mW | {least:.1f} to {most:.1f} times |',
        'multirotor hovering | {standard:.1f} W | "almost one third": 4.0 W | {third:.1f} times |',
        'The ideal hover of 2 g is {ideal_hover:.0f} mW',
        'The flown hover takes {hover:.0f} mW',
        'would have to be {heavy:.1f} g heavy, hold against a draught of {draught:.1f} m/s',
        'drone takes {paper_share:.0%} of a Crazyflie\'s hover, and ours {share:.0%}.',
        '0.5 m/s against drag costs {drag:.0f} mW',
        'the multirotor fails after {standard_lasts:.0f} s',
        'gives 27 g at 1.9 to 2.1 A of 3.7 V: {standard:.1f} W with the radio.',
        'GT-MAB, flown | {cell_power:.0f} mW | {drop:.2f} V | {charge_left:.0%} | {share:.0%} |',
        'the paper\'s 1333 mW | 1333 mW | {drop_1333:.2f} V | {charge_1333:.0%} |'
        ' {paper_share:.0%} |',
        'three times that | 4.0 W | {drop_3999:.2f} V | {charge_3999:.0%} |',
        'multirotor, flown | {standard:.1f} W | fails at 3.0 V after {standard_lasts:.0f} s |'
        ' {charge_standard:.0%} |',
    ),
    'docs/cells.md': (
        '{powerfilm_small_led_standby:.1f} mW | {powerfilm_small_led_transmitting:.1f} mW |',
        '{powerfilm_small_sun_standby:.1f} mW | {powerfilm_small_sun_transmitting:.1f} mW |',
        '{powerfilm_large_led_standby:+.1f} mW | {powerfilm_large_led_transmitting:+.1f} mW |',
        '{powerfilm_large_sun_standby:+.1f} mW | {powerfilm_large_sun_transmitting:+.1f} mW |',
        '{anysolar_led_standby:+.1f} mW | {anysolar_led_transmitting:.1f} mW |',
        '{anysolar_sun_standby:+.1f} mW | {anysolar_sun_transmitting:+.1f} mW |',
    ),
    'docs/mounting.md': (
        'pitch rms | {side_rms:.3f}° | {bottom_rms:.3f}° | {top_rms:.3f}° |',
        'peak-to-peak range | {side_swing:.2f}° | {bottom_swing:.2f}° | {top_swing:.2f}° |',
        'swing after lift-off | ±{side_misplaced_swing:.2f}°',
        '{side_out_of_place:.1f} cm off on the side',
    ),
    'docs/mission.md': (
        '| flown [min] | **{flown_a}** {flown_a_ci} | {flown_b} {flown_b_ci} |'
        ' {flown_c} {flown_c_ci} |',
        '| flights | {flights_a:.0f} | {flights_b:.0f} | {flights_c:.0f} |',
        '| harvested [kJ] | {harvested_a:.1f} | {harvested_b:.1f} | {harvested_c:.1f} |',
        '| not harvested, cell full [kJ] | {curtailed_a:.1f} | {curtailed_b:.1f} |'
        ' {curtailed_c:.1f} |',
        '| failures | {failures_a} | {failures_b} | {failures_c} |',
        '| {imbalance_a:.0e} | {imbalance_b:.0e} | {imbalance_c:.0e} |',
        'flies **{gain:.2f} ({gain_low:.2f} to {gain_high:.2f}) times** as long',
        'Sleep alone gains {asleep:.0f} %.',
        'takes {seconds:.0f} s on average, at {in_flight_a:.1f} W.',
        'lifts {slack:.1f} g more at noon',
        'GT-MAB can counter {held:.1f} g',
        'would need {ballast:.1f} g more ballast',
        '| not flown, too light | {not_flown_a:.0f} | {not_flown_b:.0f} | {not_flown_c:.0f} |',
        '| steady white LED | {net_led:.0f} | {ratio_led:.1f} : 1 | {an_hour_led:.0f} |',
        'half of the time | {net_flicker:.0f} | {ratio_flicker:.1f} : 1 | {an_hour_flicker:.0f} |',
        '| sun | {net_sun:.0f} | {ratio_sun:.1f} : 1 | {an_hour_sun:.0f} |',
        'the net charging of {net_led:.0f} mW is',
        'With our {in_flight_a:.1f} W in flight this gives {ratio_led:.1f} : 1'
        ' and {an_hour_led:.0f} minutes',
        'at {idle_led:.1f} klx of white LED, {idle_flicker:.1f} klx of a flickering one, or'
        ' {idle_sun:.1f} klx of sun. It supplies hovering at {hover_sun:.0f} klx of sun',
    ),
    'config/scenarios/windy_field.yaml': (
        'roughness of 0.3 m it leaves {hull_8:.2f} m/s # at the hull',
        'above {level_limit:.2f} m/s of airspeed it rises',
    ),
    'config/sweeps/light_reference_winds.yaml': (
        '{hull_8:.2f} m/s at the hull for 8 m/s, {hull_14:.2f} m/s for 14 m/s.',
    ),
    'docs/control.md': (
        '**In {hull_8:.2f} m/s**',
        '| windy_field, {hull_8:.2f} m/s |',
        '| windy_field, {hull_8:.2f} m/s, expected wind 1 m/s |',
    ),
    'docs/validation.md': ('0.3 m is {hull_8:.2f} m/s at the hull',),
}  # fmt: skip
POWER = re.compile(r'(?<![\d.])(\d+(?:\.\d+)?) (?:mW|W|kJ|minutes)(?![\w/])')
# What the paper prints, what a vehicle file says, and what follows from a data sheet
GIVEN = {
    'docs/energy_budget.md': '97 23 120 190 1523 1333 21 1544 27 63 4.0',
    'docs/mission.md': '18 1777 444 6 97',
}


def load(name):
    return json.loads((GOLDEN / name).read_text(encoding='utf-8'))


def reproduced():
    """Return measures of the reproduction; powers of a flight and of charging in mW."""
    rows = load('paper_full.json')['rows']
    values = {
        name: value[0]
        for row in ('outdoors', 'energy', 'cells', 'mounting')
        for name, value in rows[row]['values'].items()
    }
    for name in ('take_off', 'hover', 'fly', 'bag', 'des', 'dga', 'ideal_hover'):
        values[name] *= 1e3
    for name in values:
        if name.startswith(('net_', 'powerfilm_', 'anysolar_')):
            values[name] *= 1e3
        if name.endswith(('_rms', '_swing')):
            values[name] = math.degrees(values[name])
    values['side_out_of_place'] *= 1e2
    strategies = [values[name] / NAVIGATE for name in ('bag', 'des', 'dga')]
    return values | {
        'hover_ratio': values['hover'] / HOVER,
        'heavy': 1e3 * values['heavy'],
        'least': min(strategies),
        'most': max(strategies),
        'third': 1e3 * values['standard'] / (3.0 * HOVER),
        'drag': values['fly'] - values['hover'],
        'charge_left': 1.0 - values['charge_used'],
    }


def lived(net):
    """Return figures of the summer day, of the schedules as a, b, c; `net`: charging [mW]."""
    stored = load('mission_summer.json')
    gain = stored['flight_time_ratios']['duty cycle']
    found = {'gain': gain['value'], 'gain_low': gain['low'],
             'gain_high': gain['high'], 'slack': 1e3 * stored['gas']['slack_gain'],
             'held': 1e3 * stored['gas']['held'],
             'ballast': 1e3 * stored['gas']['ballast']}  # fmt: skip
    for key, schedule in zip('abc', ('by light', 'duty cycle', 'duty cycle, asleep'), strict=True):
        lives = [life for life in stored['lives'] if life['schedule'] == schedule]

        def mean(name, lives=lives):
            return sum(life[name] for life in lives) / len(lives)

        minutes = format_value(bootstrap_mean([life['flown'] / 60.0 for life in lives]), 0)
        found[f'flown_{key}'], _, found[f'flown_{key}_ci'] = minutes.partition(' ')
        found[f'flights_{key}'], found[f'in_flight_{key}'] = mean('flights'), mean('in_flight')
        found[f'not_flown_{key}'] = mean('not_flown')
        found[f'harvested_{key}'] = mean('harvested') / 1e3
        found[f'curtailed_{key}'] = mean('curtailed') / 1e3
        found[f'imbalance_{key}'] = max(abs(life['imbalance']) for life in lives)
        found[f'failures_{key}'] = str(
            sum(sum(life['failures'].values()) for life in lives) or 'none'
        )
        found[f'seconds_{key}'] = mean('flown') / mean('flights')
        found[f'all_{key}'] = mean('flown')
    found['asleep'] = 100.0 * (found['all_c'] / found['all_b'] - 1.0)
    found['seconds'] = round(found['seconds_a'], -1)
    for light in ('led', 'flicker', 'sun'):
        found[f'ratio_{light}'] = 1e3 * stored['lives'][0]['in_flight'] / net[f'net_{light}']
        found[f'an_hour_{light}'] = 60.0 / found[f'ratio_{light}']
    return found


def frozen():
    """Return what hovering does to a cell, and at what light the array supplies loads [klx]."""
    with (ROOT / 'test/same/frozen/commands.csv').open(encoding='utf-8', newline='') as file:
        rows = dict(csv.reader(file))
    cell = 'energy budget / on_one_cell'
    found = {'cell_power': 1e3 * float(rows[f'{cell}.flown.gtmab.power']),
             'charge_standard': float(rows[f'{cell}.flown.multirotor.charge'])}  # fmt: skip
    for power in (1333, 3999):
        for name in ('drop', 'charge'):
            found[f'{name}_{power}'] = float(rows[f'{cell}.paper.paper, {power} mW.{name}'])
    kinds = {'led': 'white LED', 'flicker': 'flickering LED', 'sun': 'sun'}
    array = 'energy breakeven / break_even_lux.2 x anysolar (as it is)'
    for key, light in kinds.items():
        found[f'idle_{key}'] = 1e-3 * float(rows[f'{array}.{light}.idle'])
    return found | {'hover_sun': 1e-3 * float(rows[f'{array}.sun.hovering (paper)'])}


@pytest.fixture(scope='module')
def stored():
    values = reproduced()
    return values | lived(values) | frozen()


def fill(quote, stored):
    """Return a quote with its values, as pages write numbers."""
    text = re.sub(r'(?<=\d)%', ' %', quote.format(**stored))
    return re.sub(r'e-0?(\d+)', r'e-\1', text)


def read(page):
    return ' '.join((ROOT / page).read_text(encoding='utf-8').split())


@pytest.mark.parametrize(
    ('page', 'quote'), [(page, quote) for page, quotes in QUOTES.items() for quote in quotes]
)
def test_a_page_quotes_the_stored_result(page, quote, stored):
    assert fill(quote, stored) in read(page), f'{page} does not say: {fill(quote, stored)}'


@pytest.mark.parametrize('page', GIVEN)
def test_every_power_energy_and_time_of_a_page_is_stored_or_given(page, stored):
    text = read(page)
    for quote in QUOTES[page]:
        text = text.replace(fill(quote, stored), '')
    assert set(POWER.findall(text)) <= set(GIVEN[page].split())
