"""The strategies in wind, and what each costs an update."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
import math
from statistics import median
import time as clock
from typing import Any, Final

from lta_config.typed import typed
from lta_control.strategies.protocol import Strategy
from lta_flight.ingredients import gather, loop_of
from lta_model.vehicle import load_vehicle
from lta_report.curves import Array
from lta_report.drawing import blank
from lta_sim.wind_limits import share_at_hull, static_limit
from lta_studies.energy.tables import Table
from lta_studies.light.evaluation.cells import Cell
from lta_studies.light.evaluation.pictures import colour, LEGEND
from lta_studies.light.evaluation.tracks import fly_again, picture
from lta_studies.light.evaluation.words import strategy as called
from lta_studies.reproduce.flights import (
    command,
    figures,
    fly,
    Group,
    PAPERS,
    record,
    share_of,
    uncrowded,
)
from lta_studies.reproduce.found import Asked, Found, Picture, Value
import numpy as np
from plotly.graph_objects import Figure, Scatter

WIND: Final = 'scenario.air.profile.wind'
ROUGH: Final = 'scenario.air.profile.roughness'
WINDS: Final = (8.0, 14.0)  # m/s, seed paper
GROUNDS: Final = (0.3, 0.35, 0.4, 0.45)  # m
MOST: Final = 0.5  # of the flights
ALGORITHMS: Final = {  # seed paper, table of algorithms: diodes, position, load
    'bag': ('several', 'not needed', 'low'), 'des': ('one', 'not needed', 'medium'),
    'dga': ('one', 'needed', 'high'),
}  # fmt: skip
HEIGHT, REFERENCE, SHOWN = 0.5, 10.0, 0.4  # m; of the hull, of the wind, a ground it can fly over
TRACKS: Final = (
    'Ways over ground from above, seed 1, wind from the lamp to the start. Told to fly 1 m/s. '
    'Dashed circle: the metre within which the lamp counts as reached.'
)
DISTANCES: Final = 'Distance to the lamp by time, seed 1; dotted the metre that counts as reached.'


def study(asked: Asked) -> Found:
    """Return who reaches the lamp against the paper's winds, over which ground, how costly."""
    speeds = WINDS[:1] if asked.quick else WINDS
    winds = fly('winds', asked.seeds, vary={WIND: [f'{each:g} m/s' for each in speeds]})
    values: dict[str, Value] = {}
    for name in PAPERS:
        for speed in speeds:
            values |= reached(f'{name}_{speed:g}', winds, name, speed)
    values |= hull()
    if asked.quick:
        return Found(values, pictures(asked, winds))
    grounds = fly(
        'roughness', asked.seeds, strategies=('bag',),
        vary={ROUGH: [f'{each:g} m' for each in GROUNDS]},
    )  # fmt: skip
    rough = fly(
        'roughness', asked.seeds, strategies=(*PAPERS, 'homing'), vary={ROUGH: [f'{SHOWN:g} m']}
    )
    for name in (*PAPERS, 'homing'):
        values |= reached(f'{name}_rough', rough, name, SHOWN)
    values['bag_rough_time'] = figures('x', at(rough, 'bag', SHOWN))['x_time']
    values['bag_from_roughness'] = Value(from_ground(grounds), seeds=asked.seeds)
    values |= {f'{name}_update': Value(cost(name), seeds=1) for name in PAPERS}
    return Found(values, pictures(asked, winds, rough), [algorithms(values)])


def at(group: Group, strategy: str, place: float) -> Cell:
    """Return the flights of a strategy at a place on the axis of its set."""
    return next(
        each for each in group.cells
        if each.strategy == strategy and math.isclose(each.place, place)
    )  # fmt: skip


def reached(name: str, group: Group, strategy: str, place: float) -> dict[str, Value]:
    """Return the share that reached the lamp."""
    return {f'{name}_reached': share_of(at(group, strategy, place))}


def from_ground(grounds: Group) -> float:
    """Return the least roughness over which most flights of BAG arrive in 8 m/s. [m]"""
    over = [each.place for each in grounds.cells if each.reached.value > MOST]
    return min(over, default=math.nan)


def hull() -> dict[str, Value]:
    """Return what the paper's winds are at the hull, and what it can fly in, by numbers. [m/s]"""
    vehicle = load_vehicle('gtmab')
    parts = {each: share_at_hull(vehicle, HEIGHT, REFERENCE, each) for each in (0.3, SHOWN)}
    return {
        'hull_8': Value(8.0 * parts[0.3]),
        'hull_14': Value(14.0 * parts[0.3]),
        'hull_8_rough': Value(8.0 * parts[SHOWN]),
        'level_limit': Value(static_limit(vehicle)),
    }


def cost(name: str) -> float:
    """Return how long one update of a strategy takes, median over an indoor flight. [s]"""
    loop = loop_of(gather('gtmab', 'lamp_room', name, ''), 1)
    inner, took = loop.policy.strategy, []

    def timed(*given: Any) -> Any:  # noqa: ANN401 - as strategies are called
        begun = clock.perf_counter()
        answer = inner.steer(*given)
        took.append(clock.perf_counter() - begun)
        return answer

    loop.policy = replace(loop.policy, strategy=Strategy(inner.name, inner.start, timed))
    for _ in loop.flight():
        pass
    return median(took)


def algorithms(found: Mapping[str, Value]) -> Table:
    """Return the paper's table of algorithms, its load of computing measured."""
    rows = []
    for name, (diodes, position, load) in ALGORITHMS.items():
        value = found[f'{name}_update'].value
        assert not isinstance(value, str)
        rows.append([called(name), diodes, position, load, f'{1e6 * value:.1f} µs'])
    heads = ('algorithm', 'diodes', 'position', 'load, paper', 'an update, measured here')
    return Table('Algorithms', heads, rows)


def pictures(asked: Asked, winds: Group, rough: Group | None = None) -> list[Picture]:
    """Return ways and distances in the paper's winds, and over a ground that can be flown."""
    made = []
    drawn: list[tuple[str, str, Group, Sequence[Cell]]] = [
        (f'wind_{wind:g}', f'{wind:g} m/s at 10 m over 0.3 m of roughness', winds,
         [at(winds, name, wind) for name in (PAPERS[:1] if asked.quick else PAPERS)])
        for wind in (WINDS[:1] if asked.quick else WINDS)
    ]  # fmt: skip
    if rough is not None:
        over = [at(rough, name, SHOWN) for name in (*PAPERS, 'homing')]
        drawn.append(('wind_rough', f'8 m/s at 10 m over {SHOWN:g} m of roughness', rough, over))
    for name, heading, group, cells in drawn:
        tracks, scenario = fly_again(group.plan, cells, 1)
        bag = '' if asked.quick else record(group, cells, 1, asked.folder / name)
        again = command(group, cells[0], 1)
        above = (
            uncrowded(picture(tracks, scenario, HEIGHT))
            .update_xaxes(dtick=10)
            .update_yaxes(dtick=10)
        )
        made.append(Picture(name, heading, TRACKS, above, again, bag))
        if name == 'wind_8':
            x, y, _ = scenario.goal_lamp.position.vector
            lines = {
                each.strategy: (each.time, np.hypot(each.x - x, each.y - y)) for each in tracks
            }
            made.append(
                Picture('distance', 'Distance to the lamp in 8 m/s', DISTANCES,
                        distances(lines), typed('light', 'evaluate', '--sets', 'winds'), bag)
            )  # fmt: skip
    return made


def distances(lines: Mapping[str, tuple[Array, Array]]) -> Figure:
    """Return the distance to the lamp by time."""
    figure = blank()
    for name, (time, values) in lines.items():
        figure.add_trace(
            Scatter(
                x=time, y=values, mode='lines', name=called(name),
                line={'color': colour(name), 'width': 1.6}, hovertemplate='%{y:.1f} m',
            )
        )  # fmt: skip
    figure.add_hline(y=1.0, line={'width': 1, 'dash': '2px,3px'})
    figure.update_xaxes(title_text='time [s]')
    figure.update_yaxes(title_text='distance to the lamp [m]', rangemode='tozero')
    return figure.update_layout(showlegend=True, legend=LEGEND)
