# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a sweep."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from statistics import median, quantiles
from typing import Any, Final

from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import format_count
from lta_config.schema.sweep_file import Distribution
from lta_flight.flight_spec import build_vehicle_scenario_stack, to_set_args
from lta_flight.sweep.batch_workers import FAILED, SweepRow
from lta_flight.sweep.pictures import (
    find_map_parameters,
    MEASURES,
    plot_by_parameter,
    plot_heat_map,
    plot_histogram,
    plot_outcomes,
)
from lta_flight.sweep.plan import MOST_TRACKED_FLIGHTS, SweepPlan
from lta_flight.sweep.run import describe_origin, SweepRun
from lta_flight.sweep.statistics import collect_result_values, format_value, REACHED, reached_share
from lta_model.drawing.scene import draw_static_scene
from lta_report.flight_scene import FanFlight, render_fan
from lta_report.formatting import format_number, Tile
from lta_report.palette import ESTIMATE, TRUTH
from lta_report.report import Block, Grid, Picture, Report, TextSection, TextTable
import numpy as np
import yaml

SMALL_MASS: Final = 0.5  # kg; smaller masses are shown in grams
LISTED_FLIGHTS: Final = 25  # most flights in the table of those that did not reach their goal
MEASURE_HEADINGS: Final = {
    'search_time': 'Time from the first forward command',
    'path_length': 'Path',
}
SWEEP_SCENE_CAPTION: Final = (
    f'At most {MOST_TRACKED_FLIGHTS} flights, spread evenly over the table, all from their start. '
    'Blue reached their goal, orange did not. Room, lamps and hull are those of the sweep file '
    'without its variations.'
)
LOST_HEADING: Final = 'Flights that did not reach their goal'
BY_PARAMETER: Final = (
    'Of {flights} flights: the share that reached the goal, with its 95 % Wilson interval, and '
    'the time and path of those. Flights that could not be flown do not count.'
)
ON_MAP: Final = (
    'Of {flights} flights: the share that reached the goal, and the median time of those.'
)


def build_report(done: SweepRun) -> Report:
    """Return the report of a sweep, which may have been stopped."""
    plan, rows, file = done.plan, done.rows, done.plan.file
    alike = [part for part in ('vehicle', 'scenario', 'strategy') if part not in file.vary]
    figures = list(draw_parameters(plan, rows))
    vehicle, scenario, _ = build_vehicle_scenario_stack(plan.base)
    scene, time_bar, track = render_fan(
        list_tracked_flights(plan, rows),
        vehicle.file,
        draw_static_scene(scenario),
        SWEEP_SCENE_CAPTION,
    )
    return Report(
        command='sweep',
        subject=' · '.join([file.name, *(getattr(file, part) for part in alike)]),
        headline=format_headline(plan, rows),
        introduction=file.about,
        tiles=build_tiles(rows),
        blocks=[
            Grid(draw_overview(rows), columns=3),
            # A single figure has the whole width
            *(figures if len(figures) == 1 else [Grid(figures)] if figures else []),
            build_lost_table(plan, rows),
        ],
        data=to_json(done),
        facts=describe_provenance(done),
        commands=suggest_commands(done),
        files={'Sweep file': yaml.safe_dump(file.model_dump(exclude_none=True), sort_keys=False)},
        closing=describe_run(done),
        status=find_status(done),
        scene=scene,
        time_bar=time_bar,
        track=track,
    )


def list_tracked_flights(plan: SweepPlan, rows: Sequence[SweepRow]) -> list[FanFlight]:
    """Return the flights of the 3-D view, named by their parameters, seed and outcome."""
    flights = []
    for row in rows:
        if not row.track:
            continue
        values = [
            f'{path.rpartition(".")[2]} {format_value(row.values[path])} {unit}'.rstrip()
            for path, unit in plan.units.items()
        ]
        name = ', '.join([*values, f'seed {row.seed}: {row.outcome}'])
        colour = TRUTH if row.outcome == REACHED else ESTIMATE
        flights.append(FanFlight(name, colour, np.array(row.track)))
    return flights


def find_status(done: SweepRun) -> int:
    """Return the exit status: flights that missed the goal are results, failed ones errors."""
    if done.failure is not None:
        return 130 if isinstance(done.failure, KeyboardInterrupt) else 2
    return int(any(row.outcome == FAILED for row in done.rows))


def format_headline(plan: SweepPlan, rows: Sequence[SweepRow]) -> str:
    """Return the result in a sentence."""
    share = reached_share(rows)
    failed = sum(row.outcome == FAILED for row in rows)
    completed = len(rows) - failed
    # An interrupted sweep states how many flights it has
    begun = '' if len(rows) == plan.count else f' (of {plan.count} planned)'
    if not rows:
        return f'None of the {plan.count} planned flights has finished.'
    if not completed:
        return f'{format_count(len(rows), "flight")}{begun}: none could be flown.'
    reached = sum(row.outcome == REACHED for row in rows)
    ends = f'{100 * share.low:.1f} to {100 * share.high:.1f} %'
    lost = f', and {failed} could not be flown' if failed else ''
    return (
        f'{reached} of {len(rows)} flights{begun} reached their goal{lost}; the 95 % '
        f'confidence interval of the share that reaches it is {ends}.'
    )


def build_tiles(rows: Sequence[SweepRow]) -> list[Tile]:
    """Return tiles with the main results."""
    share = reached_share(rows)
    broken = sum(row.outcome == FAILED for row in rows)
    completed = len(rows) - broken
    interval = f'{100 * share.low:.1f} to {100 * share.high:.1f} % (Wilson, 95 %)'
    ends = f'of {format_count(completed, "flight")}; {interval}'
    wall = sum(row.wall for row in rows)
    return [
        Tile('Reached', format_number(100 * share.value if completed else None, 1), '%', ends),
        *(build_summary_tile(rows, *words) for words in (
            ('search_time', 'Time to the lamp', 's', 1), ('path_length', 'Path', 'm', 2),
            ('forward_airspeed', 'Forward airspeed', 'm/s', 2), ('energy', 'Energy', 'J', 1))
          if collect_result_values(rows, words[0])),  # batches measure no airspeed
        Tile('Flights', str(len(rows)), '',
             f'{broken} could not be flown; {wall:.0f} s of computing time'),
    ]  # fmt: skip


def build_summary_tile(
    rows: Sequence[SweepRow], name: str, words: str, unit: str, digits: int
) -> Tile:
    """Return a tile with the median and quartiles of a result over successful flights."""
    values = collect_result_values(rows, name)
    # Quartiles need two values
    if len(values) < 2:
        return Tile(
            words,
            format_number(values[0] if values else None, digits),
            unit,
            format_count(len(values), 'flight'),
        )
    low, _, high = quantiles(values, n=4)
    note = (
        f'median of {len(values)} flights; half of them between {format_number(low, digits)} and '
        f'{format_number(high, digits)}'
    )
    return Tile(words, format_number(median(values), digits), unit, note)


def draw_overview(rows: Sequence[SweepRow]) -> list[Picture]:
    """Return the figures over all flights."""
    # In ascending order, which puts the most frequent outcome at the top
    counts = Counter(row.outcome for row in rows)
    ordered = dict(sorted(counts.items(), key=lambda item: item[1]))
    spreads = [
        Picture(
            f'spread-{measure.name}', MEASURE_HEADINGS[measure.name],
            'Only flights that reached their goal.', plot_histogram(rows, measure), height=230,
        )
        for measure in MEASURES
    ]  # fmt: skip
    ended = plot_outcomes(ordered)
    return [Picture('outcomes', 'How the flights ended', '', ended, height=230), *spreads]


def draw_parameters(plan: SweepPlan, rows: Sequence[SweepRow]) -> Iterator[Picture]:
    """Yield a map, if there are two parameters, and a figure of each parameter."""
    if not rows:
        return
    if both := find_map_parameters(plan):
        figure = plot_heat_map(rows, both, plan.units)
        yield Picture('heat', f'{both[1]} against {both[0]}', ON_MAP.format(flights=len(rows)),
                      figure, height=520)  # fmt: skip
    for k, (path, unit) in enumerate(plan.units.items()):
        how = plan.file.vary.get(path)
        # A log-uniform parameter is even on a logarithmic axis
        even_in_log = isinstance(how, Distribution) and how.loguniform is not None
        figure = plot_by_parameter(*convert_to_grams(rows, path, unit), even_in_log)
        yield Picture(f'by-{k}', path, BY_PARAMETER.format(flights=len(rows)), figure, height=520)


def convert_to_grams(
    rows: Sequence[SweepRow], path: str, unit: str
) -> tuple[Sequence[SweepRow], str, str]:
    """Return rows, path and unit with small masses in grams."""
    values = [row.values[path] for row in rows]
    small = all(isinstance(value, int | float) and abs(value) < SMALL_MASS for value in values)
    if unit != 'kg' or not small:
        return rows, path, unit
    converted = [replace(row, values={**row.values, path: 1e3 * row.values[path]}) for row in rows]
    return converted, path, 'g'


def list_lost_flights(rows: Sequence[SweepRow]) -> list[SweepRow]:
    """Return the flights that did not reach their goal, failed ones first."""
    lost = [row for row in rows if row.outcome != REACHED]
    # False sorts before True
    return sorted(lost, key=lambda row: (row.outcome != FAILED, row.index))


def build_lost_table(plan: SweepPlan, rows: Sequence[SweepRow]) -> Block:
    """Return a table of the flights that did not reach their goal."""
    lost = list_lost_flights(rows)
    if not lost:
        return TextSection(LOST_HEADING, ('None.',))
    lines = [
        [
            str(row.index), str(row.seed),
            *(format_value(row.values[path]) for path in plan.units), row.outcome, row.sentence,
        ]
        for row in lost[:LISTED_FLIGHTS]
    ]  # fmt: skip
    heads = ('flight', 'seed', *plan.units, 'outcome', 'why')
    more = f' The first {LISTED_FLIGHTS} of {len(lost)}.' if len(lost) > LISTED_FLIGHTS else ''
    return TextTable(LOST_HEADING, heads, lines, f'Values in SI.{more}', printed=False)


def format_repeat_command(plan: SweepPlan, index: int) -> str:
    """Return the command that repeats one flight of a sweep, with a bag."""
    job = plan.build_job(index)
    spec = plan.base.with_values(job.changes)
    names = spec.names
    changes = [word for text in to_set_args(spec.replaced) for word in ('--set', text)]
    return format_lta_command(
        'simulate', '--vehicle', names['vehicle'], '--scenario', names['scenario'], '--strategy',
        spec.strategy, '--gains', names['gains'], '--seed', str(job.seed), *changes,
    )  # fmt: skip


def describe_provenance(done: SweepRun) -> dict[str, str]:
    """Return the provenance of the flights."""
    plan = done.plan
    return {
        **describe_origin(plan, done.order),
        'varied': ', '.join(plan.units) or 'the seed only',
        'flights': f'{len(done.rows)} of {plan.count}',
        'identity': plan.identity[:16],
    }


def suggest_commands(done: SweepRun) -> dict[str, str]:
    """Return commands for the next steps."""
    options = done.order.flight_options
    # The path is typed in the folder where the command was run
    table = relative_path(done.table)
    commands = {
        'Read the table': f'python -c "import pandas; print(pandas.read_parquet(\'{table}\'))"',
    }
    if lost := list_lost_flights(done.rows):
        # A batch has other random numbers than a single flight
        like = 'Fly one like the first lost flight' if options else 'Fly the first lost flight'
        commands[like] = format_repeat_command(done.plan, lost[0].index)
    return commands


def describe_run(done: SweepRun) -> list[str]:
    """Return what the terminal tells of this run: speed, failures, and the table."""
    lines = []
    if done.new_flights:
        rate = done.new_flights / done.wall
        lines.append(
            f'{format_count(done.new_flights, "flight")} in {done.wall:.0f} s: '
            f'{rate:.2f} flights/s.'
        )
    elif done.failure is None:
        lines.append('All flights were already stored; nothing was flown.')
    if done.lost:
        lines.append(
            f'{done.lost} worker processes ended unexpectedly; their flights were repeated or '
            'count as failed. Fly failed ones again with --retry-failed.'
        )
    failures = Counter(row.sentence for row in done.rows if row.outcome == FAILED)
    # The three most frequent reasons; the table has all
    lines += [f'{count} failed: {sentence}' for sentence, count in failures.most_common(3)]
    if done.failure is not None:
        lines.append('Finished flights are stored; repeat the command to resume.')
    # Why the sweep stopped, unless by Ctrl-C
    lines += [str(done.failure)] if str(done.failure or '') else []
    return [*lines, f'Table {relative_path(done.table)}']


def to_json(done: SweepRun) -> dict[str, Any]:
    """Return the summary as JSON content."""
    share = reached_share(done.rows)
    return {
        'flights': len(done.rows),
        'outcomes': dict(Counter(row.outcome for row in done.rows)),
        'reached_share': share.value,
        'reached_low': share.low,
        'reached_high': share.high,
        'flown': done.new_flights,
        'workers_lost': done.lost,
        # Zero if all flights were already stored
        'rate': done.new_flights / done.wall if done.wall else 0.0,
        'table': str(done.table),
        'units': {'rate': '1/s', 'reached_share': '1', 'reached_low': '1', 'reached_high': '1'},
    }
