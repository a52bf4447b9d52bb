# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare the strategies in simulation and indoors: success, path and time."""

from collections.abc import Mapping
import math
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_studies.reproduce.flights import (
    arrival_figure,
    FlightGroup,
    FLIGHTS_A_DRAW,
    fly_draws,
    fly_group,
    format_command,
    PAPERS,
    summarize_cell,
    summarize_draws,
)
from lta_studies.reproduce.strategy_flights import (
    fly_again,
    ordered_share,
    plot_paper_comparison,
    plot_tracks,
    select_track_seed,
    StrategyFlights,
)
from lta_studies.reproduce.study_result import (
    average_over_seeds,
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)
import numpy as np

SAFE: Final = {'scenario.goal.radius': '2 m'}  # the paper's simulation
FAST_CRUISE: Final = {'mission.speed': 0.87}  # m/s, the paper's path divided by its time
TOWARDS: Final = 'start_heading'
START_AHEAD: Final = {'scenario.start.heading': '0 deg', 'scenario.start.heading_spread': '30 deg'}
INDOOR_READINGS: Final[dict[str, Mapping[str, Any]]] = {
    # What the words of the paper allow, by prefix of the measures
    '': {},
    f'{TOWARDS}_': START_AHEAD,
    'equal_': {'gains.turn_first': 10.0},  # rad: the airspeed asked for, also in turns
    'other_': {  # the paper's mean; 0.3 as a frequency in Hz; dead reckoning as commanded
        'mission.bag.mean': True, 'mission.des.rate': 1.885, 'mission.dga.commanded_heading': True,
    },
    'sim_': SAFE,
    'sim_towards_': {**SAFE, **START_AHEAD},
}  # fmt: skip
INDOOR_HEADINGS: Final = {  # name and heading of the top views, by prefix of the measures
    '': ('indoors', 'Indoors: reach the lamp within 1 m, any start heading'),
    'sim_': ('simulation', "Reach the lamp within 2 m, as in the paper's simulation"),
    f'{TOWARDS}_': ('towards', 'Indoors: start heading within 30° of the lamp'),
}
FACTOR_STRATEGIES: Final = {
    'not_stopping': ('dga',),
    'no_computing': ('dga',),
    'plane_through_origin': ('dga',),
    'gradient_alone': ('des',),
    'narrow_diodes': ('dga', 'des'),
}
INDOOR_TRACK_CAPTION: Final = (
    'Ground tracks from above with the same seed; the yellow fan is the light of the lamp.'
)
INDOOR_BAR_CAPTION: Final = (
    'Share of {seeds} flights that reach the lamp, and path and time of those that do, with 95 % '
    'intervals. Stars: flights printed in the paper.'
)


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Fly as in the paper, in all readings of it, and with one factor changed at a time."""
    groups = {'': fly_group('light_indoors', request.seeds)}
    if not request.quick:
        groups |= {
            prefix: fly_group('light_indoors', request.seeds, change=change)
            for prefix, change in INDOOR_READINGS.items()
            if change
        }
    values: dict[str, MeasuredValue] = {}
    for prefix, group in groups.items():
        values |= rank_strategies(prefix, group.find_cells())
        for name in PAPERS:
            values |= summarize_cell(f'{prefix}{name}', group.find_cell(name))
        values[f'{prefix}dga_by_bag_time'] = mean_ratio(group, 'search_time', 'dga', 'bag')
        values[f'{prefix}dga_by_bag_path'] = mean_ratio(group, 'path_length', 'dga', 'bag')
    if not request.quick:
        fast = fly_group('light_indoors', request.seeds, strategies=('bag',), change=FAST_CRUISE)
        values |= summarize_cell('fast_bag', fast.find_cell('bag'))
        values |= measure_factors(request.seeds)
        values['dga_excursion'] = measure_excursion(groups['sim_'])
        values['sim_towards_dga_excursion'] = measure_excursion(groups['sim_towards_'])
    pictures = plot_indoor_flights(
        request, {prefix: groups[prefix] for prefix in INDOOR_HEADINGS if prefix in groups}
    )
    return RowStudyResult(values, pictures, draws=draw_readings(request))


def draw_readings(request: RowStudyRequest) -> dict[str, list[float | str]]:
    """Fly each reading in every draw of what is assumed; a path is that of one flight."""
    draws: dict[str, list[float | str]] = {}
    for prefix, change in INDOOR_READINGS.items():
        if request.quick and change:
            continue
        flights = 1 if request.quick else FLIGHTS_A_DRAW
        rows = fly_draws('light_indoors', request, change=change, flights=flights)
        for name, results in rows.items():
            draws |= summarize_draws(f'{prefix}{name}', results)
        figures = {
            figure: {
                name: [arrival_figure(first, figure) for first, *_ in results]
                for name, results in rows.items()
            }
            for figure in ('path_length', 'search_time')
        }
        for figure, short in (('path_length', 'path'), ('search_time', 'time')):
            dga, bag = figures[figure]['dga'], figures[figure]['bag']
            draws[f'{prefix}dga_by_bag_{short}'] = [a / b for a, b in zip(dga, bag, strict=True)]
        paths, times = (
            [{name: figures[figure][name][k] for name in PAPERS} for k in range(request.draws)]
            for figure in ('path_length', 'search_time')
        )
        draws[f'{prefix}order'] = list(map(order_paths, paths))
        draws[f'{prefix}fastest'] = list(map(name_fastest, times))
        draws[f'{prefix}dga_nearer'] = list(map(compare_dga_path, paths))
    return draws


def order_paths(paths: Mapping[str, float]) -> str:
    """Return the order of the strategies by path; 'none' unless all have one."""
    if any(math.isnan(each) for each in paths.values()):
        return 'none'
    return ' < '.join(name.upper() for name in sorted(paths, key=paths.__getitem__))


def name_fastest(times: Mapping[str, float]) -> str:
    """Return the strategy with the least time to the lamp; 'none' if none arrived."""
    arrived = {name: time for name, time in times.items() if not math.isnan(time)}
    return min(arrived, key=arrived.__getitem__).upper() if arrived else 'none'


def compare_dga_path(paths: Mapping[str, float]) -> float:
    """Return how far DGA's path is from BAG's, by how far it is from DES's; below 1 if nearer."""
    from_des = abs(paths['dga'] - paths['des'])
    return abs(paths['dga'] - paths['bag']) / from_des if from_des else math.inf


def measure_excursion(group: FlightGroup) -> MeasuredValue:
    """Return how far DGA flies away from the lamp before it approaches [m]."""
    cell = group.find_cell('dga')
    excursions = []
    for seed in cell.rows:
        (track, *_), scenario = fly_again(group.plan, [cell], seed)
        x, y, _ = scenario.goal_lamp.position.vector
        away = np.hypot(track.x - x, track.y - y)
        excursions.append(float(away.max() - away[0]))
    return average_over_seeds(excursions)


def measure_factors(seeds: int) -> dict[str, MeasuredValue]:
    """Fly with one factor changed at a time."""
    values: dict[str, MeasuredValue] = {}
    for case, strategies in FACTOR_STRATEGIES.items():
        group = fly_group('light_ablations', seeds, strategies=strategies, cases=[case])
        for name in strategies:
            values |= summarize_cell(f'{case}_{name}', group.find_cell(name))
    return values


def rank_strategies(prefix: str, cells: Mapping[str, StrategyFlights]) -> dict[str, MeasuredValue]:
    """Rank the strategies by path; add the bootstrap share that keeps the paper's order."""
    paths, times = (
        {name: cells[name].mean(figure).value for name in PAPERS}
        for figure in ('path_length', 'search_time')
    )
    # PAPERS is in the order of the paper, the shortest path first
    lengths = (cells[name].arrival_values('path_length') for name in PAPERS)
    share = ordered_share([[*each.values()] for each in lengths])
    return {
        f'{prefix}order': MeasuredValue(order_paths(paths)),
        f'{prefix}order_draws': MeasuredValue(share, seeds=len(cells['bag'].rows)),
        f'{prefix}fastest': MeasuredValue(name_fastest(times)),
        f'{prefix}dga_nearer': MeasuredValue(compare_dga_path(paths)),
    }


def mean_ratio(group: FlightGroup, figure: str, above: str, below: str) -> MeasuredValue:
    """Return the ratio of the means of two strategies."""
    top, bottom = (group.find_cell(name).mean(figure) for name in (above, below))
    value = top.value / bottom.value if bottom.value else math.nan
    return MeasuredValue(value, seeds=top.flights)


def plot_indoor_flights(
    request: RowStudyRequest, groups: Mapping[str, FlightGroup]
) -> list[StudyPicture]:
    """Plot the flights from above, and the comparison with the paper."""
    indoors = groups['']
    pictures = [
        StudyPicture('bars', 'Indoors, compared with the paper',
                     INDOOR_BAR_CAPTION.format(seeds=request.seeds),
                     plot_paper_comparison(list(indoors.cells)),
                     format_lta_command('sweep', 'light_indoors'))
    ]  # fmt: skip
    for prefix, group in groups.items():
        name, heading = INDOOR_HEADINGS[prefix]
        cells = group.cells
        seed = select_track_seed(cells)
        tracks, scenario = fly_again(group.plan, cells, seed)
        first = next(each for each in cells if each.strategy == 'bag')
        again = format_command(group, first, seed)
        pictures.append(
            StudyPicture(
                name, heading, INDOOR_TRACK_CAPTION, plot_tracks(tracks, scenario, 0.5), again
            )
        )
    return pictures
