"""A mission as one self-contained page."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_energy.harvest import Harvest
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.pieces import section, tile_html
from lta_studies.energy.tables import Table, table_html
from lta_studies.light.evaluation.intervals import Mean
from lta_studies.mission import paper
from lta_studies.mission.pictures import books_picture, day_picture, hours_picture, main, timeline
from lta_studies.mission.run import gain, minutes, of, Order, Told

DAY: Final = (
    'Above: light on the level panel, a beacon that flickers by its mean. Below: what the cell '
    'holds, by the truth.'
)
WHEN: Final = 'What the drone did when.'
HOURS: Final = "Minutes in the air in each hour. Dotted: the paper's figure for an hour at 80 klx."
BOOKS: Final = (
    'Where the energy went. What was harvested is what is drawn in flight and on the perch, lost '
    'as heat in the cell and stored; the last part was never harvested.'
)
METHOD: Final = (
    'On the perch: panel, charger, cell and loads in steps of half a minute. In flight: the '
    'compiled 6-DoF model with estimator, cascade and homing, the cell drained every hundredth of '
    'a second by what the rotors draw; the beacon is heard as geometry and noise, not as an ADC '
    'block.',
    'A duty cycle rests a fixed multiple of the last flight, awake in its hours or asleep. The '
    'schedule by light knows the clear sky, the mean of clouds and the timers, and its own count '
    'of the charge; it flies when that is safe and the night is provided for, or the cell would '
    'be full, and sleeps in between. Both refuse a flight that might not leave the reserve.',
    'A drone that does not come home is fetched, and counts as a failure.',
)


def write_page(order: Order, lives: Sequence[Told], again: Mapping[str, str], out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(order, lives, again), out)


def page(order: Order, lives: Sequence[Told], again: Mapping[str, str]) -> str:
    """Return the whole page; `again` is what can be typed next."""
    seed = order.seeds[0]
    shown = [each for each in lives if each.seed == seed]
    light = order.light(seed)
    pictures = (
        section('when', 'Timeline', WHEN, timeline(shown, light)),
        section('hours', 'Minutes flown', HOURS, hours_picture(shown, light)),
        section('books', 'Energy', BOOKS, books_picture(shown)),
    )
    return framed(
        'energy.html',
        title=escape(title(order, lives)),
        kicker=escape(f'mission · {order.mission.name}'),
        about=escape(order.mission.about),
        tiles='\n'.join(tile_html(*each) for each in tiles(order, lives)),
        first=section(
            'day',
            f'Charge with the light, seed {seed}',
            DAY,
            day_picture(shown, light, order.mission.reserve.si),
        ),
        pictures=''.join(pictures),
        tables=''.join(table_html(each) for each in tables(order, lives)),
        method=''.join(f'<p class="note">{escape(each)}</p>' for each in METHOD),
        facts={
            'mission': order.mission.name,
            'vehicle': order.mission.vehicle,
            'light': order.day.about,
            'seeds': ', '.join(map(str, order.seeds)),
            'commit': commit(),
        },
        commands=again,
    )


def title(order: Order, lives: Sequence[Told]) -> str:
    """Return what came out, in a sentence."""
    first = main(lives)
    own = minutes(of(lives, first.schedule), order.days)
    more = gain(lives)
    told = f'{order.mission.name} flies {own.value:.0f} minutes a day'
    if more is None:
        return f'{told}.'
    return f'{told}, {more.value:.2f} times as many as by a fixed duty cycle.'


def tiles(order: Order, lives: Sequence[Told]) -> list[Tile]:
    """Return the figures of the page."""
    first = main(lives)
    alike, days = of(lives, first.schedule), order.days
    count = len(alike)
    made = [
        Tile('flown', spread(minutes(alike, days), 0), 'min a day', first.schedule),
        Tile(
            'flights',
            f'{sum(each.figures.flights for each in alike) / count / days:.0f}',
            'a day',
            f'{sum(each.figures.visits for each in alike) / count / days:.0f} beacons visited',
        ),
        Tile(
            'failures',
            f'{sum(each.figures.failed for each in alike)}',
            '',
            f'in {sum(each.figures.flights for each in alike)} flights',
        ),
        Tile(
            'lowest charge',
            f'{100.0 * min(each.figures.lowest_charge or 0.0 for each in alike):.0f}',
            '%',
            f'after a flight; reserve {100.0 * order.mission.reserve.si:.0f} %',
        ),
        Tile('in flight', f'{1e3 * first.figures.in_flight:.0f}', 'mW', 'paper: 1523 to 1544'),
    ]
    more = gain(lives)
    if more is not None:
        made.insert(1, Tile('by duty cycle', spread(more, 2), 'times', 'ours by the naive'))
    return made


def spread(value: Mean, digits: int) -> str:
    """Return a mean with its interval where there is one."""
    if value.flights < 2:
        return f'{value.value:.{digits}f}'
    return f'{value.value:.{digits}f} ({value.low:.{digits}f} to {value.high:.{digits}f})'


def tables(order: Order, lives: Sequence[Told]) -> list[Table]:
    """Return all tables of the page."""
    vehicle, first = order.scenes.vehicle, main(lives)
    power = first.figures.in_flight or paper.NAVIGATE
    ratios = paper.ratios(Harvest(vehicle.panel), vehicle.charger, vehicle.loads.idle, power)
    return [schedules(order, lives), paper.table(ratios)]


def schedules(order: Order, lives: Sequence[Told]) -> Table:
    """Return how each schedule fared, a day."""
    rows = []
    for name in order.schedules:
        alike = of(lives, name)
        per = len(alike) * order.days
        kinds: dict[str, int] = {}
        for each in alike:
            for kind, count in each.figures.failures.items():
                kinds[kind] = kinds.get(kind, 0) + count
        told = ', '.join(f'{count} {kind}' for kind, count in kinds.items()) or 'none'
        figures = [each.figures for each in alike]
        rows.append(
            [
                name,
                spread(minutes(alike, order.days), 0),
                f'{sum(f.flights for f in figures) / per:.0f}',
                f'{sum(f.rounds for f in figures) / per:.0f}',
                f'{sum(f.harvested for f in figures) / per / 1e3:.1f}',
                f'{sum(f.curtailed for f in figures) / per / 1e3:.1f}',
                f'{100.0 * sum(f.asleep for f in figures) / len(figures):.0f}',
                f'{max(abs(f.imbalance) for f in figures):.0e}',
                told,
            ]
        )
    heads = [
        'a day', 'flown [min]', 'flights', 'whole rounds', 'harvested [kJ]', 'wasted [kJ]',
        'asleep [%]', 'books off by', 'failures in all',
    ]  # fmt: skip
    note = f'Over {len(order.seeds)} seeds of {order.days} d, in brackets 95 % intervals.'
    return Table('How the schedules fared', heads, rows, note)
