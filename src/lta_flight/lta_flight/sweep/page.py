"""Write the page of a sweep as one HTML file."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from statistics import median, quantiles
from typing import final

from lta_config.command_line import format_lta_command, relative_path
from lta_config.schema.sweep_file import Distribution
from lta_flight.flight_spec import to_set_args
from lta_flight.sweep.heat_map import find_map_parameters, plot_heat_map
from lta_flight.sweep.job_runner import FAILED, SweepRow
from lta_flight.sweep.pictures import MEASURES, plot_by_parameter, plot_histogram, plot_outcomes
from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.statistics import collect_result_values, format_value, REACHED, reached_share
from lta_report.formatting import format_number, Tile
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
import yaml

NAME = 'report.html'
SMALL = 0.5  # kg; smaller masses are shown in grams
LISTED = 25  # most flights in the table of those that did not reach their goal


@final
@dataclass(frozen=True, slots=True)
class SweepPageData:
    """Content of the page: the plan, its rows, their folder, and their provenance."""

    plan: SweepPlan
    rows: Sequence[SweepRow]
    units: Mapping[str, str]
    folder: Path
    typed_file: str
    origin: Mapping[str, str]
    options: tuple[str, ...] = ()


def write_page(data: SweepPageData) -> Path:
    """Write the page of a sweep and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(data), data.folder / NAME)


def render_page(data: SweepPageData) -> str:
    """Return the whole page."""
    plan, rows = data.plan, data.rows
    file = plan.file
    return assemble_page(
        'sweep.html',
        title=escape(format_title(plan, rows)),
        kicker=escape(f'sweep {file.name} · {file.vehicle} · {file.scenario} · {file.strategy}'),
        about=escape(file.about),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(rows)),
        spreads='\n'.join(render_overview_figures(rows)),
        panels='\n'.join(render_parameter_figures(plan, rows, data.units)),
        lost_title='Flights that did not reach their goal',
        lost=render_lost_flights(plan, rows, batch=bool(data.options)),
        facts=describe_provenance(data),
        commands=suggest_commands(data),
        files={'Sweep file': yaml.safe_dump(file.model_dump(exclude_none=True), sort_keys=False)},
    )


def format_title(plan: SweepPlan, rows: Sequence[SweepRow]) -> str:
    """Return the result in a sentence."""
    share = reached_share(rows)
    failed = sum(row.outcome == FAILED for row in rows)
    flown = len(rows) - failed
    # An interrupted sweep states how many flights it has
    begun = '' if len(rows) == plan.count else f' (of {plan.count} planned)'
    if not flown:
        return f'{len(rows)} flights{begun}: none could be flown.'
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
    ends = f'{100 * share.low:.1f} to {100 * share.high:.1f} % (Wilson, 95 %)'
    broken = sum(row.outcome == FAILED for row in rows)
    wall = sum(row.wall for row in rows)
    flown = len(rows) - broken
    return [
        Tile('Reached', format_number(100 * share.value if flown else None, 1), '%', ends),
        *(build_summary_tile(rows, *words) for words in (
            ('search_time', 'Time to the lamp', 's', 1), ('path_length', 'Path', 'm', 2),
            ('airspeed', 'Airspeed', 'm/s', 2), ('energy', 'Energy', 'J', 1))),
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
            words, format_number(values[0] if values else None, digits), unit, 'one flight or none'
        )
    low, _, high = quantiles(values, n=4)
    note = (
        f'median; half of the flights between {format_number(low, digits)} and '
        f'{format_number(high, digits)}'
    )
    return Tile(words, format_number(median(values), digits), unit, note)


def render_overview_figures(rows: Sequence[SweepRow]) -> list[str]:
    """Return the figures over all flights."""
    # In ascending order, which puts the most frequent outcome at the top
    counts = Counter(row.outcome for row in rows)
    ordered = dict(sorted(counts.items(), key=lambda item: item[1]))
    first = render_section('outcomes', 'How the flights ended', '', plot_outcomes(ordered))
    words = {'search_time': 'Time from the first forward command', 'path_length': 'Path'}
    return [first] + [
        render_section(
            f'spread-{measure.name}', words[measure.name], 'Only flights that reached their goal.',
            plot_histogram(rows, measure),
        )
        for measure in MEASURES
    ]  # fmt: skip


def render_parameter_figures(
    plan: SweepPlan, rows: Sequence[SweepRow], units: Mapping[str, str]
) -> list[str]:
    """Return a figure for each parameter."""
    caption = (
        'Share of flights that reached the goal with its 95 % Wilson interval, and their time and '
        'path. Flights that could not be flown do not count.'
    )
    found = []
    if rows and (both := find_map_parameters(plan)):
        words = f'{both[1]} against {both[0]}'
        about = 'Share of the flights that reached their goal, and the median time of those.'
        found.append(render_section('heat', words, about, plot_heat_map(rows, both, units)))
    for k, (path, unit) in enumerate(units.items() if rows else ()):
        how = plan.file.vary.get(path)
        # A log-uniform parameter is even on a logarithmic axis
        even_in_log = isinstance(how, Distribution) and how.loguniform is not None
        picture = plot_by_parameter(*convert_to_grams(rows, path, unit), even_in_log)
        found.append(render_section(f'by-{k}', path, caption, picture))
    return found


def convert_to_grams(
    rows: Sequence[SweepRow], path: str, unit: str
) -> tuple[Sequence[SweepRow], str, str]:
    """Return rows, path and unit with small masses in grams."""
    values = [row.values[path] for row in rows]
    small = all(isinstance(value, int | float) and abs(value) < SMALL for value in values)
    if unit != 'kg' or not small:
        return rows, path, unit
    shown = [replace(row, values={**row.values, path: 1e3 * row.values[path]}) for row in rows]
    return shown, path, 'g'


def render_lost_flights(plan: SweepPlan, rows: Sequence[SweepRow], *, batch: bool = False) -> str:
    """Return a table of the flights that did not reach their goal, failed ones first."""
    lost = [row for row in rows if row.outcome != REACHED]
    if not lost:
        return '<p class="note">None.</p>'
    # False sorts before True
    lost.sort(key=lambda row: (row.outcome != FAILED, row.index))
    heads = ['flight', 'seed', *plan.units, 'outcome', 'why']
    lines = [
        [
            str(row.index), str(row.seed),
            *(format_value(row.values[path]) for path in plan.units), row.outcome, row.sentence,
        ]
        for row in lost[:LISTED]
    ]  # fmt: skip
    like = 'one like the first one, with other random numbers' if batch else 'the first one'
    more = f' The first {LISTED} of {len(lost)}.' if len(lost) > LISTED else ''
    head = ''.join(f'<th scope="col">{escape(cell)}</th>' for cell in heads)
    body = ''.join(
        f'<tr>{"".join(f"<td>{escape(cell)}</td>" for cell in line)}</tr>' for line in lines
    )
    return (
        f'<table class="flights"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
        f'<p class="note">Values in SI.{more} To see {like}:</p>'
        f'<p><code>{escape(format_repeat_command(plan, lost[0].index))}</code></p>'
    )


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


def describe_provenance(data: SweepPageData) -> dict[str, str]:
    """Return the provenance of the flights."""
    plan = data.plan
    return {
        **data.origin,
        'varied': ', '.join(plan.units) or 'the seed only',
        'flights': f'{len(data.rows)} of {plan.count}',
        'identity': plan.identity[:16],
    }


def suggest_commands(data: SweepPageData) -> dict[str, str]:
    """Return commands for the next steps."""
    # The path is typed in the folder where the command was run
    table = relative_path(data.folder / 'flights.parquet')
    return {
        'Resume or repeat the sweep': format_lta_command(
            'sweep', data.typed_file, *data.options, '--out', relative_path(data.folder)
        ),
        'Read the table': f'python -c "import pandas; print(pandas.read_parquet(\'{table}\'))"',
    }
