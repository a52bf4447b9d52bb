# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a mission."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_config.errors import format_count
from lta_model.drawing.scene import draw_static_scene
from lta_report.flight_scene import FanFlight, render_fan
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, TRUTH
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_report.result_table import build_table, Column, format_value
from lta_studies.mission.flyer import MOST_TRACKED_MISSION_FLIGHTS
from lta_studies.mission.gas import (
    describe_gas,
    draw_slack,
    estimate_gas_over_day,
    GasOverDay,
)
from lta_studies.mission.pictures import (
    draw_charge,
    draw_energy_use,
    draw_flight_hours,
    draw_timeline,
    select_main_result,
)
from lta_studies.mission.run import (
    filter_by_schedule,
    find_best_rival,
    mean_daily_minutes,
    MissionFigures,
    MissionRequest,
    MissionResult,
    ratio_to_rival,
)
import numpy as np

LIGHT_AND_CHARGE_CAPTION: Final = (
    'Top: light on the level panel, averaged over the flicker of a beacon. Bottom: true state of '
    'charge of the cell.'
)
WHEN: Final = 'State of the drone over time.'
HOURS: Final = (
    'Minutes in the air in each hour. Dotted: 18 minutes in an hour at 80 klx, stated in '
    'the paper (Huang et al. 2025).'
)
BOOKS: Final = (
    'Where the energy of the light went: used in flight, used on the perch, lost as heat in '
    'the cell, or stored. The last part could not be harvested because the cell was full.'
)
MISSION_SCENE_CAPTION: Final = (
    f'The first flights of the mission, at most {MOST_TRACKED_MISSION_FLIGHTS}, all from their '
    'take-off. Blue came home, orange did not.'
)
MISSION_METHOD: Final = (
    'On the perch, panel, charger, cell and loads are simulated in steps of half a minute. '
    'In flight, the compiled 6-DoF model is used with estimator, controller and homing, and '
    'the power of the rotors drains the cell every 10 ms. The light link is computed from '
    'geometry and noise, without ADC samples.',
    'With a fixed duty cycle, the drone rests for a fixed multiple of its last flight, '
    'either awake in its active hours or asleep. The light-aware schedule (by light) uses the '
    'clear-sky light, the mean cloud cover, the timers and its own charge estimate. It '
    'flies when that is safe and enough charge is left for the night, or when the cell '
    'would be full; in between it sleeps. Neither schedule starts a flight that might use '
    'up the reserve.',
    'A drone that does not return is fetched and counts as a failure.',
)


def build_report(request: MissionRequest, results: Sequence[MissionResult]) -> Report:
    """Return the report of a mission."""
    mission, seed = request.mission, request.seeds[0]
    # The plots show the first seed only; tiles and tables average over all.
    selected = [each for each in results if each.seed == seed]
    light, gas = request.simulate_light(seed), estimate_gas(request)
    scene, time_bar, track = render_fan(
        list_tracked_flights(select_main_result(selected)),
        request.scenes.vehicle.file,
        draw_static_scene(request.scenes.scenario),
        MISSION_SCENE_CAPTION,
    )
    return Report(
        command='mission',
        subject=mission.name,
        headline=format_headline(request, results),
        introduction=mission.about,
        tiles=build_tiles(request, results),
        blocks=(
            Picture(
                'day', f'Light and state of charge, seed {seed}', LIGHT_AND_CHARGE_CAPTION,
                draw_charge(selected, light, mission.reserve.si),
            ),
            Picture('when', 'Timeline', WHEN, draw_timeline(selected, light), height=250),
            Picture('hours', 'Minutes flown', HOURS, draw_flight_hours(selected, light)),
            Picture('books', 'Energy', BOOKS, draw_energy_use(selected)),
            build_schedule_table(request, results),
            TextSection('Gas over the day', (describe_gas(gas),)),
            TextSection('Meaning and method', MISSION_METHOD),
        ),
        data=to_json(request, results),
        facts={
            'mission': mission.name,
            'vehicle': mission.vehicle,
            'light': request.day.about,
            'seeds': ', '.join(map(str, request.seeds)),
        },
        commands={
            'Fly between its beacons': format_lta_command(
                'simulate', '--scenario', request.mission.scene, '--strategy', 'homing'
            ),
            "The paper's ratios of charging to flight": format_lta_command('reproduce', 'energy'),
        },
        scene=scene, time_bar=time_bar, track=track,
    )  # fmt: skip


def list_tracked_flights(result: MissionResult) -> list[FanFlight]:
    """Return the flights of the 3-D view, named by the time of day and how they ended."""
    return [
        FanFlight(
            f'{format_clock(flight.start)}: {flight.ending}',
            TRUTH if flight.ending == 'home' else ESTIMATE,
            np.array(flight.track),
        )
        for flight in result.diary.flights
        if flight.track
    ]


def format_clock(time: float) -> str:
    """Return a time since the first midnight [s] as a time of day."""
    hours, minutes = divmod(int(time // 60), 60)
    return f'{hours % 24:02}:{minutes:02}'


def estimate_gas(request: MissionRequest) -> GasOverDay:
    """Return the change of lift in the light of the first seed."""
    light = request.simulate_light(request.seeds[0])
    return estimate_gas_over_day(request.scenes.vehicle, light)


def to_json(request: MissionRequest, results: Sequence[MissionResult]) -> dict[str, Any]:
    """Convert the figures of all missions to JSON, in SI units."""
    gas, own = estimate_gas(request), select_main_result(results).schedule
    ratios = {name: ratio_to_rival(results, name) for name in request.schedules if name != own}
    return {
        'mission': request.mission.name,
        'days': request.days,
        # By schedule: how many times as long the light-aware one flies
        'flight_time_ratios': {
            name: None if ratio is None else ratio._asdict() for name, ratio in ratios.items()
        },
        'gas': asdict(gas) | {'ballast': gas.ballast},
        'lives': [
            {
                'schedule': each.schedule,
                'seed': each.seed,
                **asdict(each.figures),
                'slack': draw_slack(each.seed),
            }
            for each in results
        ],
    }


def format_headline(request: MissionRequest, results: Sequence[MissionResult]) -> str:
    """Return the headline."""
    first = select_main_result(results)
    own = mean_daily_minutes(filter_by_schedule(results, first.schedule), request.days)
    rival = find_best_rival(results)
    more = None if rival is None else ratio_to_rival(results, rival)
    sentence = (
        f'In the mission {request.mission.name} the drone flies {own.value:.0f} minutes a day'
    )
    if more is not None:
        percent = round(100.0 * (more.value - 1.0))
        amount = f'{abs(percent)} % {"more" if percent > 0 else "less"} than' if percent else 'as'
        sentence += f', {amount} with the best other schedule ({rival})'
    alike = filter_by_schedule(results, first.schedule)
    if failed := sum(each.figures.failure_count for each in alike):
        count = sum(each.figures.flights for each in alike)
        sentence += f'; {format_count(failed, "failure")} in {format_count(count, "flight")}'
    if grounded := sum(each.figures.not_flown for each in alike):
        sentence += (
            f'; {format_count(grounded, "flight")} not flown, as the sun made the drone too light'
        )
    return f'{sentence}.'


def build_tiles(request: MissionRequest, results: Sequence[MissionResult]) -> list[Tile]:
    """Return the tiles of the page."""
    first = select_main_result(results)
    alike, days = filter_by_schedule(results, first.schedule), request.days
    count = len(alike)
    tiles = [
        Tile(
            'flown',
            format_value(mean_daily_minutes(alike, days), 0),
            'min a day',
            f'{first.schedule}, {format_count(count, "run")} of {format_count(days, "day")}',
        ),
        Tile(
            'flights',
            f'{sum(each.figures.flights for each in alike) / count / days:.0f}',
            'a day',
            f'{sum(each.figures.visits for each in alike) / count / days:.0f} beacons '
            'visited a day',
        ),
        Tile(
            'failures',
            f'{sum(each.figures.failure_count for each in alike)}',
            '',
            f'in {format_count(sum(each.figures.flights for each in alike), "flight")}',
        ),
        Tile(
            'lowest charge',
            f'{100.0 * min(each.figures.lowest_charge or 0.0 for each in alike):.0f}',
            '%',
            f'after a flight; reserve {100.0 * request.mission.reserve.si:.0f} %',
        ),
        Tile('in flight', f'{1e3 * first.figures.in_flight:.0f}', 'mW', 'paper: 1523 to 1544'),
    ]
    rival = find_best_rival(results)
    more = None if rival is None else ratio_to_rival(results, rival)
    if more is not None:
        # Directly after the flown minutes, to which it refers
        tiles.insert(
            1,
            Tile(
                'gain',
                format_value(more, 2),
                'times',
                f'the flight time of the best other schedule, {rival}',
            ),
        )
    return tiles


def build_schedule_table(request: MissionRequest, results: Sequence[MissionResult]) -> TextTable:
    """Return the table of daily figures for each schedule."""
    alike = {name: filter_by_schedule(results, name) for name in request.schedules}

    def column(
        head: str, unit: str, digits: int, of: Callable[[MissionFigures], float]
    ) -> Column[str]:
        """Return a column of means per simulated day of a schedule, over all seeds."""

        def mean(name: str) -> float:
            figures = [each.figures for each in alike[name]]
            return abs(sum(map(of, figures))) / (len(figures) * request.days)

        return Column('', head, unit, digits, mean, 1e-3 if unit == 'kJ' else None)

    def count_failures(name: str) -> str:
        kinds: Counter[str] = Counter()
        for each in alike[name]:
            kinds.update(each.figures.failures)
        return ', '.join(f'{count} {kind}' for kind, count in kinds.items()) or 'none'

    columns: list[Column[str]] = [
        Column('', 'a day', of=lambda name: name),
        Column('', 'flown [min]',
               of=lambda name: format_value(mean_daily_minutes(alike[name], request.days), 0)),
        column('flights', '', 0, lambda each: each.flights),
        column('not flown', '', 0, lambda each: each.not_flown),
        column('whole rounds', '', 0, lambda each: each.rounds),
        column('harvested', 'kJ', 1, lambda each: each.harvested),
        column('wasted', 'kJ', 1, lambda each: each.curtailed),
        column('asleep', '%', 0, lambda each: each.asleep * request.days),
        # The worst seed: a mean could hide an error of the energy balance
        Column('', 'energy imbalance', of=lambda name:
               f'{max(abs(each.figures.imbalance) for each in alike[name]):.0e}'),
        Column('', 'total failures', of=count_failures),
    ]  # fmt: skip
    note = (
        f'Means per day over {format_count(len(request.seeds), "seed")} of {request.days} d; '
        '95 % intervals in brackets.'
    )
    return build_table('Results of the schedules', columns, request.schedules, note)
