"""Build the report of an evaluation."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_flight.sweep.statistics import ShareInterval
from lta_report.formatting import format_count, Tile
from lta_report.json_value import replace_nonfinite
from lta_report.report import Block, Grid, Picture, Report, STOPPED, TextSection
from lta_report.result_table import format_value
from lta_studies.light.evaluation import pictures, tables
from lta_studies.light.evaluation.cells import BootstrapMean, EvaluationCell, select_pilot_cells
from lta_studies.light.evaluation.flights import PILOT
from lta_studies.light.evaluation.run import EvaluationStatus
from lta_studies.light.evaluation.sets import (
    ABLATIONS,
    find_flight_set,
    INDOORS,
    SETS,
    UNIFORM,
)

CELL_FIGURES: Final = {'path_length': 'm', 'search_time': 's', 'flight_time': 's', 'energy': 'J'}
EVALUATION_METHOD: Final = (
    'Reached: share of the flights, with 95 % Wilson interval. Path, time and ratios: means '
    'over the flights that reached the lamp, with 95 % bootstrap intervals. Path: length '
    'over ground from take-off to the goal circle. Time: from the first forward command. '
    'The pilot is a reference that knows the lamp and the wind and flies as straight as '
    'vehicle, controller and mission allow. Ratios to it are over the seeds in which both '
    'arrived.'
)


def build_report(status: EvaluationStatus, *, with_pictures: bool = True) -> Report:
    """Return the report of an evaluation; its pictures are optional."""
    return Report(
        command='light evaluate',
        subject=describe_flights(status),
        headline=format_headline(status),
        introduction=describe_evaluation(status),
        tiles=build_tiles(status),
        blocks=(
            *(build_pictures(status) if with_pictures else ()),
            *build_tables(status),
            TextSection('Method', (EVALUATION_METHOD,)),
        ),
        data=to_json(status),
        facts=build_provenance_table(status),
        commands=suggest_commands(status),
        closing=describe_run(status),
        json_name='evaluation.json',
        status=STOPPED if status.stopped else int(count_failed(status) > 0),
    )


def count_flights(status: EvaluationStatus) -> int:
    """Return the number of flights, failed ones included."""
    return count_failed(status) + sum(
        len(cell.rows) for own in status.cells.values() for cell in own
    )


def count_failed(status: EvaluationStatus) -> int:
    """Return the number of flights that could not be simulated."""
    return sum(cell.failed for own in status.cells.values() for cell in own)


def describe_flights(status: EvaluationStatus) -> str:
    """Return the number of flights in words."""
    count, failed = count_flights(status), count_failed(status)
    # An evaluation that was stopped has fewer flights than requested.
    of = '' if count == status.total else f' of {status.total}'
    return f'{count}{of} flights' + (
        f', {failed} of which could not be simulated' if failed else ''
    )


def format_headline(status: EvaluationStatus) -> str:
    """Return the share of flights of each strategy that reached the lamp."""
    names = [name for name, own in status.cells.items() if any(cell.rows for cell in own)]
    if not names:
        return 'No flight could be simulated.'
    # The headline is about the indoor set if it was flown, else the first set.
    name = INDOORS if INDOORS in names else names[0]
    cells = [cell for cell in status.cells[name] if cell.rows and cell.strategy != PILOT]
    shares = ', '.join(
        f'{tables.label_strategy(cell.strategy)} {100 * cell.reached_share.value:.0f} %'
        for cell in cells
        # Of a set with several cases only the first fits into a headline.
        if cell.case == cells[0].case
    )
    where = 'Indoors from 7 m' if name == INDOORS else SETS[name].title
    failed = count_failed(status)
    return f'{where}, the lamp is reached by {shares} (share of the flights).' + (
        f' {failed} of {count_flights(status)} flights failed.' if failed else ''
    )


def describe_evaluation(status: EvaluationStatus) -> str:
    """Describe what was flown."""
    sets, seeds = len(status.cells), status.order.seeds
    return (
        f'Navigation strategies, flown in {format_count(sets, "set")} of scenes with '
        f'{format_count(seeds, "seed")} each, the same seeds for all strategies.'
    )


def describe_run(status: EvaluationStatus) -> list[str]:
    """Return lines on the computing time, and on how to resume."""
    lines = ['All flights were already stored; nothing was flown.']
    if status.new_flights:
        # Processor time per flight [s]
        each = status.work / max(count_flights(status), 1)
        lines = [
            f'{format_count(status.new_flights, "flight")} in {status.wall:.0f} s: '
            f'{status.new_flights / status.wall:.1f} flights/s; '
            f'{each:.2f} s of processor time per flight.'
        ]
    if status.stopped:
        lines.append(f'Stopped: {describe_flights(status)}; repeat the command to resume.')
    return lines


def build_tiles(status: EvaluationStatus) -> list[Tile]:
    """Return tiles of the strategies in the first set with flights."""
    cells = next((own for own in status.cells.values() if own), [])
    return [
        Tile(
            tables.label_strategy(cell.strategy), f'{100 * cell.reached_share.value:.0f}', '%',
            f'of {format_count(len(cell.rows), "flight")} reached; path '
            f'{format_value(cell.mean("path_length"), 1)} m',
        )
        for cell in cells
        if cell.strategy != PILOT and cell.rows and cell.case == cells[0].case
    ]  # fmt: skip


def build_pictures(status: EvaluationStatus) -> list[Block]:
    """Return the pictures of all sets with flights; the ablations need the whole width."""
    strategies = {
        name: own
        for name, cells in status.cells.items()
        if (own := [cell for cell in cells if cell.rows])
    }
    indoors, ablations = strategies.pop(INDOORS, []), strategies.pop(ABLATIONS, [])
    blocks: list[Block] = []
    if indoors:
        blocks.append(Grid(draw_indoors(status, indoors)))
    if strategies:
        blocks.append(Grid([draw_set(name, cells) for name, cells in strategies.items()]))
    if ablations:
        blocks.append(draw_set(ABLATIONS, ablations))
    return blocks


def draw_indoors(status: EvaluationStatus, cells: Sequence[EvaluationCell]) -> list[Picture]:
    """Return the pictures of the indoor set: comparison with the paper, and tracks."""
    part, plan = find_flight_set(INDOORS), status.plans[INDOORS]
    # One seed for all tracks, so that start and noise are the same.
    seed = pictures.select_track_seed(cells)
    results, scenario = pictures.fly_again(plan, cells, seed)
    altitude = plan.base.read_value('mission.altitude')
    return [
        Picture(
            INDOORS, part.title, part.about, pictures.plot_paper_comparison(cells), height=470
        ),
        Picture(
            'tracks', 'One flight of each strategy',
            f'All strategies with the same seed, seen from above. Seed {seed}.',
            pictures.plot_tracks(results, scenario, altitude), height=470,
        ),
    ]  # fmt: skip


def draw_set(name: str, cells: Sequence[EvaluationCell]) -> Picture:
    """Return the picture of a set along its axis, or of its factors."""
    part = find_flight_set(name)
    figure = (
        pictures.plot_factors(cells) if part.axis is None
        else pictures.plot_along_axis(cells, part.axis)
    )  # fmt: skip
    # A factor has up to four lines of text
    factors = len({cell.case for cell in cells})
    height = 120 + 62 * factors if part.axis is None else 640 if name == UNIFORM else 430
    return Picture(name, part.title, part.about, figure, height=height)


def build_tables(status: EvaluationStatus) -> list[Block]:
    """Return the tables that have rows."""
    results = (tables.build_set_table(name, own) for name, own in status.cells.items())
    return [each for each in results if each.rows]


def build_provenance_table(status: EvaluationStatus) -> dict[str, str]:
    """Return the origin of the results."""
    return {
        'sets': ', '.join(status.cells),
        'sweeps': ', '.join(find_flight_set(name).file for name in status.cells),
        'seeds': f'1 to {status.order.seeds}',
        'flights': describe_flights(status),
        'work': f'{status.work:.0f} s of processor time',
    }


def suggest_commands(status: EvaluationStatus) -> dict[str, str]:
    """Return commands for the next steps."""
    commands = {
        'Fly only one set': format_lta_command(
            'sweep', find_flight_set(next(iter(status.cells))).file
        ),
    }
    if ABLATIONS in status.cells:
        commands['Fly only the ablations'] = format_lta_command(
            'sweep', find_flight_set(ABLATIONS).file
        )
    return commands


def to_json(status: EvaluationStatus) -> dict[str, Any]:
    """Convert the results to JSON, with NaN as null."""
    content: dict[str, Any] = replace_nonfinite(
        {
            'seeds': status.order.seeds,
            'flights': count_flights(status),
            'failed': count_failed(status),
            'sets': {name: encode_cells(own) for name, own in status.cells.items()},
            'units': {**CELL_FIGURES, 'reached': '1', 'ratio': '1'},
        }
    )
    return content


def encode_cells(cells: Sequence[EvaluationCell]) -> list[Mapping[str, Any]]:
    """Convert the cells of a set to JSON."""
    best = select_pilot_cells(cells)

    def encode_cell(cell: EvaluationCell) -> Mapping[str, Any]:
        intervals: dict[str, ShareInterval | BootstrapMean] = {
            'reached': cell.reached_share,
            **{name: cell.mean(name) for name in CELL_FIGURES},
            'ratio': cell.ratio_to(best.get(cell.case)),
        }
        return {
            'case': cell.case, 'strategy': cell.strategy, 'place': cell.place,
            'flights': len(cell.rows), 'failed': cell.failed,
            **{name: value._asdict() for name, value in intervals.items()},
        }  # fmt: skip

    return [encode_cell(cell) for cell in cells]
