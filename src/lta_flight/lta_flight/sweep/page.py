"""A sweep as one self-contained HTML file, in the look of a flight's page."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from statistics import median, quantiles
from typing import final

from lta_config.schema.sweep_file import Distribution
from lta_config.typed import near, typed
from lta_flight.ingredients import spoken
from lta_flight.sweep.flown import FAILED, Row
from lta_flight.sweep.heat import heat, two_lists
from lta_flight.sweep.pictures import by_parameter, MEASURES, outcomes, spread
from lta_flight.sweep.plan import Plan
from lta_flight.sweep.statistics import figures, REACHED, reached_share, told
from lta_report.formatting import number, Tile
from lta_report.frame import framed, written
from lta_report.pieces import section, tile_html
import yaml

NAME = 'report.html'
SMALL = 0.5  # kg; masses below are shown in grams
LISTED = 25  # flights that did not reach their goal, by name


@final
@dataclass(frozen=True, slots=True)
class Told:
    """What the page is made of: the plan, its rows, where they are kept, and their origin."""

    plan: Plan
    rows: Sequence[Row]
    units: Mapping[str, str]
    folder: Path
    typed_file: str
    origin: Mapping[str, str]
    options: tuple[str, ...] = ()


def write_page(told_of: Told) -> Path:
    """Write the page of a sweep and return where it is; `BadInput` where it cannot be written."""
    return written(page(told_of), told_of.folder / NAME)


def page(told_of: Told) -> str:
    """Return the whole page."""
    plan, rows = told_of.plan, told_of.rows
    file = plan.file
    return framed(
        'sweep.html',
        title=escape(title(plan, rows)),
        kicker=escape(f'sweep {file.name} · {file.vehicle} · {file.scenario} · {file.strategy}'),
        about=escape(file.about),
        tiles='\n'.join(tile_html(*each) for each in tiles(rows)),
        spreads='\n'.join(spreads(rows)),
        panels='\n'.join(panels(plan, rows, told_of.units)),
        lost_title='Flights that did not reach their goal',
        lost=lost_html(plan, rows, batch=bool(told_of.options)),
        facts=facts(told_of),
        commands=commands(told_of),
        files={'Sweep file': yaml.safe_dump(file.model_dump(exclude_none=True), sort_keys=False)},
    )


def title(plan: Plan, rows: Sequence[Row]) -> str:
    """Return what came out, in a sentence."""
    share = reached_share(rows)
    flown = sum(row.outcome != FAILED for row in rows)
    begun = '' if len(rows) == plan.count else f' (of {plan.count} planned)'
    if not flown:
        return f'{len(rows)} flights{begun}: none could be flown.'
    reached = sum(row.outcome == REACHED for row in rows)
    ends = f'{100 * share.low:.1f} to {100 * share.high:.1f} %'
    return (
        f'{reached} of {flown} flights{begun} reached their goal; with 95 % confidence it is '
        f'{ends} of all such flights.'
    )


def tiles(rows: Sequence[Row]) -> list[Tile]:
    """Return the figures that matter most."""
    share = reached_share(rows)
    ends = f'{100 * share.low:.1f} to {100 * share.high:.1f} % (Wilson, 95 %)'
    broken = sum(row.outcome == FAILED for row in rows)
    wall = sum(row.wall for row in rows)
    flown = len(rows) - broken
    return [
        Tile('Reached', number(100 * share.value if flown else None, 1), '%', ends),
        *(summary(rows, *words) for words in (
            ('search_time', 'Time to the lamp', 's', 1), ('path_length', 'Path', 'm', 2),
            ('airspeed', 'Airspeed', 'm/s', 2), ('energy', 'Energy', 'J', 1))),
        Tile('Flights', str(len(rows)), '', f'{broken} could not be flown; {wall:.0f} s of work'),
    ]  # fmt: skip


def summary(rows: Sequence[Row], name: str, words: str, unit: str, digits: int) -> Tile:
    """Return the median of a figure with the middle half of the flights that reached."""
    values = figures(rows, name)
    if len(values) < 2:
        return Tile(
            words, number(values[0] if values else None, digits), unit, 'one flight or none'
        )
    low, _, high = quantiles(values, n=4)
    note = f'median; half between {number(low, digits)} and {number(high, digits)}'
    return Tile(words, number(median(values), digits), unit, note)


def spreads(rows: Sequence[Row]) -> list[str]:
    """Return the pictures over all flights."""
    counts = Counter(row.outcome for row in rows)
    ordered = dict(sorted(counts.items(), key=lambda item: item[1]))
    first = section('outcomes', 'How the flights ended', '', outcomes(ordered))
    words = {'search_time': 'Time from the first forward command', 'path_length': 'Path'}
    return [first] + [
        section(
            f'spread-{measure.name}', words[measure.name], 'Of those that reached their goal.',
            spread(rows, measure),
        )
        for measure in MEASURES
    ]  # fmt: skip


def panels(plan: Plan, rows: Sequence[Row], units: Mapping[str, str]) -> list[str]:
    """Return a picture for each parameter."""
    caption = (
        'Share that reached the goal with its 95 % Wilson interval, and time and path of those '
        'that did. Failed flights do not count.'
    )
    found = []
    if rows and (both := two_lists(plan)):
        words = f'{both[1]} against {both[0]}'
        about = 'Share of the flights that reached their goal, and the median time of those.'
        found.append(section('heat', words, about, heat(rows, both, units)))
    for k, (path, unit) in enumerate(units.items() if rows else ()):
        how = plan.file.vary.get(path)
        even_in_log = isinstance(how, Distribution) and how.loguniform is not None
        picture = by_parameter(*in_grams(rows, path, unit), even_in_log)
        found.append(section(f'by-{k}', path, caption, picture))
    return found


def in_grams(rows: Sequence[Row], path: str, unit: str) -> tuple[Sequence[Row], str, str]:
    """Return rows, path and unit with small masses in grams, as everybody weighs a blimp."""
    values = [row.values[path] for row in rows]
    small = all(isinstance(value, int | float) and abs(value) < SMALL for value in values)
    if unit != 'kg' or not small:
        return rows, path, unit
    shown = [replace(row, values={**row.values, path: 1e3 * row.values[path]}) for row in rows]
    return shown, path, 'g'


def lost_html(plan: Plan, rows: Sequence[Row], *, batch: bool = False) -> str:
    """Return the flights that did not reach their goal, the failed first."""
    lost = [row for row in rows if row.outcome != REACHED]
    if not lost:
        return '<p class="note">There is none.</p>'
    lost.sort(key=lambda row: (row.outcome != FAILED, row.index))
    heads = ['flight', 'seed', *plan.units, 'outcome', 'why']
    lines = [
        [
            str(row.index), str(row.seed), *(told(row.values[path]) for path in plan.units),
            row.outcome, row.sentence,
        ]
        for row in lost[:LISTED]
    ]  # fmt: skip
    like = 'one like the first, with other chance' if batch else 'one'
    more = f' The first {LISTED} of {len(lost)}.' if len(lost) > LISTED else ''
    head = ''.join(f'<th scope="col">{escape(cell)}</th>' for cell in heads)
    body = ''.join(
        f'<tr>{"".join(f"<td>{escape(cell)}</td>" for cell in line)}</tr>' for line in lines
    )
    return (
        f'<table class="flights"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
        f'<p class="note">Values in SI.{more} To see {like}:</p>'
        f'<p><code>{escape(repeat(plan, lost[0].index))}</code></p>'
    )


def repeat(plan: Plan, index: int) -> str:
    """Return the command that flies one flight of a sweep again, with a bag."""
    job = plan.job(index)
    made_of = plan.base.with_values(job.changes)
    names = made_of.names
    changes = [word for text in spoken(made_of.replaced) for word in ('--set', text)]
    return typed(
        'simulate', '--vehicle', names['vehicle'], '--scenario', names['scenario'], '--strategy',
        made_of.strategy, '--gains', names['gains'], '--seed', str(job.seed), *changes,
    )  # fmt: skip


def facts(told_of: Told) -> dict[str, str]:
    """Return where the flights come from."""
    plan = told_of.plan
    return {
        **told_of.origin,
        'varied': ', '.join(plan.units) or 'the seed alone',
        'flights': f'{len(told_of.rows)} of {plan.count}',
        'identity': plan.identity[:16],
    }


def commands(told_of: Told) -> dict[str, str]:
    """Return how to go on."""
    table = near(told_of.folder / 'flights.parquet')
    return {
        'Go on, or fly it again': typed(
            'sweep', told_of.typed_file, *told_of.options, '--out', near(told_of.folder)
        ),
        'Read the table': f'python -c "import pandas; print(pandas.read_parquet(\'{table}\'))"',
    }
