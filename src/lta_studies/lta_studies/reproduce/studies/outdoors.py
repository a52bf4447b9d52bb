# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Study the strategies in wind, and the computing time of one update."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
import math
from statistics import median
import time as clock
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_config.quantity import Quantity
from lta_control.strategies.protocol import NavigationStrategy
from lta_flight.flight_spec import build_loop, build_vehicle_scenario_stack, FlightSpec, load_spec
from lta_flight.sweep.statistics import wilson_interval
from lta_model.limits import level_speed
from lta_model.vehicle import load_vehicle
from lta_report.charts import ChartAxis, Curve, draw_curves, Level
from lta_report.curves import Array
from lta_report.report import TextTable
from lta_sim.wind_limits import static_wind_limit, wind_share_at_hull
from lta_studies.reproduce.flights import (
    FlightGroup,
    FLIGHTS_A_DRAW,
    fly_draws,
    fly_group,
    format_command,
    measure_success_share,
    PAPERS,
    summarize_cell,
    summarize_draws,
    thin_annotations,
)
from lta_studies.reproduce.strategy_flights import (
    fly_again,
    label_strategy,
    PILOT,
    plot_tracks,
    strategy_color,
    StrategyFlights,
)
from lta_studies.reproduce.study_result import (
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
    yes_no_value,
)
import numpy as np
from plotly.graph_objects import Figure

WIND_PATH: Final = 'scenario.air.profile.wind'
ROUGHNESS_PATH: Final = 'scenario.air.profile.roughness'
EDDY_STRENGTH: Final = {'scenario.air.turbulence.strength': {'value': 1.0, 'unit': '1'}}
OUTDOOR_WINDS: Final = (8.0, 14.0)  # m/s, seed paper
GROUNDS: Final = (0.3, 0.35, 0.4, 0.45)  # m
MOST_SHARE: Final = 0.5  # share of the flights that counts as most
ALGORITHMS: Final = {  # seed paper, table of algorithms: diodes, position, load
    'bag': ('several', 'not needed', 'low'), 'des': ('one', 'not needed', 'medium'),
    'dga': ('one', 'needed', 'high'),
}  # fmt: skip
OUTDOOR_HEIGHT, REFERENCE_HEIGHT, SHOWN_ROUGHNESS = (
    0.5,
    10.0,
    0.45,
)  # m: hull, reference wind, a flyable roughness
OUTDOOR_CAPTION: Final = (
    'Ground tracks from above, seed 1. The wind blows from the lamp to the start; the '
    'airspeed command is 0.7 m/s. Dashed circle: 1 m from the lamp, which counts as reached.'
)
DISTANCE_CAPTION: Final = (
    'Distance to the lamp over time, seed 1. Dotted: 1 m, which counts as reached.'
)


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Fly in the paper's winds and over rough ground, and time the updates."""
    speeds = OUTDOOR_WINDS[:1] if request.quick else OUTDOOR_WINDS
    flyers = PAPERS if request.quick else (*PAPERS, PILOT)
    winds = fly_group(
        'light_reference_winds',
        request.seeds,
        strategies=flyers,
        vary={WIND_PATH: [f'{w:g} m/s' for w in speeds]},
    )
    values: dict[str, MeasuredValue] = {}
    for name in flyers:
        for speed in speeds:
            values |= measure_reached_share(f'{name}_{speed:g}', winds, name, speed)
    values |= hull_winds()
    values['bag_8_time'] = measure_time(winds, 'bag', OUTDOOR_WINDS[0])
    draws = draw_winds(request)
    if request.quick:
        return RowStudyResult(values, plot_outdoor_flights(request, winds), draws=draws)
    for speed in OUTDOOR_WINDS:
        # If even the pilot fails, who knows wind and lamp, the failure of a strategy says nothing
        values[f'vacuous_{speed:g}'] = yes_no_value(
            find_cell(winds, PILOT, speed).reached_share.value <= MOST_SHARE
        )
    gusts = fly_group(
        'light_reference_winds',
        request.seeds,
        vary={WIND_PATH: [f'{OUTDOOR_WINDS[0]:g} m/s']},
        change=EDDY_STRENGTH,
    )
    for name in PAPERS:
        values |= measure_reached_share(f'{name}_gusts', gusts, name, OUTDOOR_WINDS[0])
    values['des_8_away'], values['dga_8_past'] = measure_failures(winds)
    grounds = fly_group(
        'light_roughness', request.seeds, strategies=('bag',),
        vary={ROUGHNESS_PATH: [f'{each:g} m' for each in GROUNDS]},
    )  # fmt: skip
    rough = fly_group(
        'light_roughness',
        request.seeds,
        strategies=(*PAPERS, 'homing'),
        vary={ROUGHNESS_PATH: [f'{SHOWN_ROUGHNESS:g} m']},
    )
    for name in (*PAPERS, 'homing'):
        values |= measure_reached_share(f'{name}_rough', rough, name, SHOWN_ROUGHNESS)
    values['bag_rough_time'] = measure_time(rough, 'bag', SHOWN_ROUGHNESS)
    values['bag_from_roughness'] = MeasuredValue(
        minimum_flyable_roughness(grounds), seeds=request.seeds
    )
    values |= {
        f'{name}_update': MeasuredValue(measure_update_time(name), seeds=1) for name in PAPERS
    }
    return RowStudyResult(
        values, plot_outdoor_flights(request, winds, rough), [build_algorithm_table(values)], draws
    )


def draw_winds(request: RowStudyRequest) -> dict[str, list[float | str]]:
    """Fly both winds in every draw, and compare them with the thrust."""
    draws: dict[str, list[float | str]] = {}
    for speed in OUTDOOR_WINDS[:1] if request.quick else OUTDOOR_WINDS:
        rows = fly_draws(
            'light_reference_winds',
            request,
            change={WIND_PATH: f'{speed:g} m/s'},
            flights=1 if request.quick else FLIGHTS_A_DRAW,
        )
        for name, results in rows.items():
            summary = summarize_draws(f'{name}_{speed:g}', results)
            draws |= {key: each for key, each in summary.items() if not key.endswith('_path')}
    draws['wind_by_thrust_14'] = [
        compare_wind_with_thrust(request.draw_changes(seed)) for seed in request.draw_seeds
    ]
    return draws


def compare_wind_with_thrust(changes: Mapping[str, Any]) -> float:
    """Return 14 m/s at 10 m, at the hull, by the airspeed that the thrust allows [1]."""
    spec = load_spec('gtmab', 'windy_field', 'bag', '').with_values(changes)
    vehicle = build_vehicle_scenario_stack(spec)[0]
    share = wind_share_at_hull(vehicle, OUTDOOR_HEIGHT, REFERENCE_HEIGHT, spec_roughness(spec))
    return OUTDOOR_WINDS[1] * share / level_speed(vehicle)


def spec_roughness(spec: FlightSpec) -> float:
    """Return the roughness of the ground of a spec [m]."""
    return Quantity.model_validate(spec.read_value(ROUGHNESS_PATH)).si


def measure_failures(winds: FlightGroup) -> tuple[MeasuredValue, MeasuredValue]:
    """
    Return how the single-diode strategies fail in 8 m/s.

    The share of DES's flights that end farther from the lamp than they began, and that of DGA's
    that fly past the lamp: upwind of it by more than the goal's radius.
    """
    shares = []
    for name in ('des', 'dga'):
        cell = find_cell(winds, name, OUTDOOR_WINDS[0])
        failures = []
        for seed in cell.rows:
            (track, *_), scenario = fly_again(winds.plan, [cell], seed)
            x, y, _ = scenario.goal_lamp.position.vector
            away = np.hypot(track.x - x, track.y - y)
            past = float(track.x.max()) > x + scenario.goal.radius.si
            failures.append(past if name == 'dga' else bool(away[-1] > away[0]))
        share = wilson_interval(sum(failures), len(failures))
        shares.append(MeasuredValue(share.value, share.low, share.high, len(failures)))
    return shares[0], shares[1]


def find_cell(group: FlightGroup, strategy: str, place: float) -> StrategyFlights:
    """Return the flights of a strategy at a value of what the sweep varies."""
    return next(
        each for each in group.cells
        if each.strategy == strategy and math.isclose(each.place, place)
    )  # fmt: skip


def measure_reached_share(
    name: str, group: FlightGroup, strategy: str, place: float
) -> dict[str, MeasuredValue]:
    """Return the share that reached the lamp."""
    return {f'{name}_reached': measure_success_share(find_cell(group, strategy, place))}


def measure_time(group: FlightGroup, strategy: str, place: float) -> MeasuredValue:
    """Return the time of the flights that reached the lamp [s]."""
    return summarize_cell('x', find_cell(group, strategy, place))['x_time']


def minimum_flyable_roughness(grounds: FlightGroup) -> float:
    """Return the smallest roughness over which most BAG flights arrive in 8 m/s [m]."""
    over = [each.place for each in grounds.cells if each.reached_share.value > MOST_SHARE]
    return min(over, default=math.nan)


def hull_winds() -> dict[str, MeasuredValue]:
    """Return the paper's winds at the height of the hull, and the static limit [m/s]."""
    vehicle = load_vehicle('gtmab')
    parts = {
        each: wind_share_at_hull(vehicle, OUTDOOR_HEIGHT, REFERENCE_HEIGHT, each)
        for each in (0.3, SHOWN_ROUGHNESS)
    }
    return {
        'hull_8': MeasuredValue(8.0 * parts[0.3]),
        'hull_14': MeasuredValue(14.0 * parts[0.3]),
        'hull_8_rough': MeasuredValue(8.0 * parts[SHOWN_ROUGHNESS]),
        'level_limit': MeasuredValue(static_wind_limit(vehicle)),
        'wind_by_thrust_14': MeasuredValue(14.0 * parts[0.3] / level_speed(vehicle)),
    }


def measure_update_time(name: str) -> float:
    """Return the median computing time of one strategy update in an indoor flight [s]."""
    loop = build_loop(load_spec('gtmab', 'lamp_room', name, ''), 1)
    inner, took = loop.policy.strategy, []

    # Wrap the strategy, so that only its update is timed.
    def steer_with_timer(*given: Any) -> Any:
        begun = clock.perf_counter()
        answer = inner.steer(*given)
        took.append(clock.perf_counter() - begun)
        return answer

    loop.policy = replace(
        loop.policy, strategy=NavigationStrategy(inner.name, inner.start, steer_with_timer)
    )
    for _ in loop.iterate_steps():
        pass
    # The median ignores interruptions by other processes.
    return median(took)


def build_algorithm_table(values: Mapping[str, MeasuredValue]) -> TextTable:
    """Return the paper's table of algorithms with measured computing times."""
    rows = []
    for name, (diodes, position, load) in ALGORITHMS.items():
        value = values[f'{name}_update'].value
        assert not isinstance(value, str)
        rows.append([label_strategy(name), diodes, position, load, f'{1e6 * value:.1f} µs'])
    heads = ('algorithm', 'diodes', 'position', 'load, paper', 'time per update, here')
    return TextTable('Algorithms', heads, rows)


def plot_outdoor_flights(
    request: RowStudyRequest, winds: FlightGroup, rough: FlightGroup | None = None
) -> list[StudyPicture]:
    """Plot tracks and distances in the paper's winds, and over a flyable ground."""
    pictures = []
    views: list[tuple[str, str, FlightGroup, Sequence[StrategyFlights]]] = [
        (f'wind_{wind:g}', f'Wind of {wind:g} m/s at 10 m height, ground roughness 0.3 m', winds,
         [find_cell(winds, name, wind) for name in (PAPERS[:1] if request.quick else PAPERS)])
        for wind in (OUTDOOR_WINDS[:1] if request.quick else OUTDOOR_WINDS)
    ]  # fmt: skip
    if rough is not None:
        # Our strategy is drawn for comparison where the ground makes the wind flyable.
        over = [find_cell(rough, name, SHOWN_ROUGHNESS) for name in (*PAPERS, 'homing')]
        views.append(
            (
                'wind_rough',
                f'Wind of 8 m/s at 10 m height, ground roughness {SHOWN_ROUGHNESS:g} m',
                rough,
                over,
            )
        )
    for name, heading, group, cells in views:
        tracks, scenario = fly_again(group.plan, cells, 1)
        again = format_command(group, cells[0], 1)
        above = (
            thin_annotations(plot_tracks(tracks, scenario, OUTDOOR_HEIGHT))
            .update_xaxes(dtick=10)
            .update_yaxes(dtick=10)
        )
        pictures.append(StudyPicture(name, heading, OUTDOOR_CAPTION, above, again))
        if name == 'wind_8':
            x, y, _ = scenario.goal_lamp.position.vector
            lines = {
                each.strategy: (each.time, np.hypot(each.x - x, each.y - y)) for each in tracks
            }
            pictures.append(
                StudyPicture('distance', 'Distance to the lamp in a wind of 8 m/s',
                             DISTANCE_CAPTION,
                             plot_distances(lines),
                             format_lta_command('sweep', 'light_reference_winds'))
            )  # fmt: skip
    return pictures


def plot_distances(lines: Mapping[str, tuple[Array, Array]]) -> Figure:
    """Plot the distance to the lamp by time."""
    curves = [
        Curve(label_strategy(name), *line, strategy_color(name), '%{y:.1f} m')
        for name, line in lines.items()
    ]
    distance = ChartAxis('distance to the lamp [m]', zero=True)
    return draw_curves(curves, ChartAxis('time [s]'), distance, levels=[Level(1.0)])
