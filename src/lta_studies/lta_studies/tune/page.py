"""A tuning as one self-contained HTML file, in the look of a flight's page."""

from collections.abc import Sequence
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_config.typed import near, typed
from lta_report.formatting import number, Tile
from lta_report.frame import framed, written
from lta_report.pieces import section, tile_html
from lta_studies.tune import pictures, told
from lta_studies.tune.exam import Channel, Trace
from lta_studies.tune.run import scene_name, Tuned

NAME = 'report.html'
CHANNELS: Final[tuple[tuple[Channel, str, str], ...]] = (
    ('altitude', 'Climb and sink', 'Only weight pulls it down where no rotor reverses.'),
    ('heading', 'Turn', 'Standing in the air.'),
    ('speed', 'Forward speed', 'Some speed is left of the turn before.'),
    ('course', 'Turn at speed', 'Motion through the air; the nose leans against the drift.'),
)
SEARCH: Final = 'Half the mean and half the worst of all cases. Dotted: the gains before.'
Traces = Sequence[tuple[float, Trace]]


def write_page(tuned: Tuned, old: Traces, new: Traces) -> Path:
    """Write the page of a tuning and return where it is; `BadInput` where it cannot be written."""
    return written(page(tuned, old, new), tuned.folder / NAME)


def page(tuned: Tuned, old: Traces, new: Traces) -> str:
    """Return the whole page."""
    order = tuned.order
    robust = told.table(ROBUST_HEADS, told.robust_rows(tuned))
    margins = told.table(told.MARGIN_HEADS, told.margin_rows(tuned), text=True)
    limits = told.table(('', 'old', 'new'), told.limit_rows(tuned.old.limit, tuned.new.limit))
    return framed(
        'tune.html',
        title=escape(told.typeset(told.title(tuned))),
        kicker=escape(f'tune {scene_name(order)} · from {tuned.gains_name} · seed {order.seed}'),
        about=escape(about(tuned)),
        tiles='\n'.join(tile_html(*each) for each in tiles(tuned)),
        panels='\n'.join(panels(tuned, old, new)),
        robust=robust,
        margins=margins + MARGINS_NOTE,
        gains=told.table(('number', 'old', 'new', 'searched'), told.gain_rows(tuned)),
        limits=limits + LIMITS_NOTE,
        facts=facts(tuned),
        commands=commands(tuned),
        files={'Gains file': tuned.file.read_text(encoding='utf-8')},
    )


def about(tuned: Tuned) -> str:
    """Return what was done, and what cost is."""
    order = tuned.order
    return (
        f'{len(tuned.found.history)} candidates flew {len(tuned.losses)} examinations each, with '
        f'{1e3 * order.least:g} to {1e3 * order.most:g} g of lift lost that the drone was '
        'not told of. What is compared below was flown with other draws than the search had. '
        'Cost weighs settling, overshoot, steady error, swing, work of the rotors and time of the '
        'mission; less is better.'
    )


ROBUST_HEADS = ('median (middle half), or share with 95 % interval', 'old', 'new')
MARGINS_NOTE = (
    '<p class="note">Each loop is cut at its demand, the others closed; from one linearised '
    'control period about the steady flight. Gain: how far it may fall and rise before the loop '
    'oscillates. Phase and delay: what may be lost at the crossover. Where a swing grows, the '
    'drone is not stable whatever the margins of one loop.</p>'
)
LIMITS_NOTE = (
    '<p class="note">Against the trim of the vehicle file. Held: take-off, a climb of 0.4 m and '
    'the way down again, altitude within 0.3 m at the end of each. Days are by the permeation of '
    'laminates, assumed for this film.</p>'
)


def tiles(tuned: Tuned) -> list[Tile]:
    """Return the figures that matter most."""
    old, new = tuned.old, tuned.new

    def both(name: str, words: str, unit: str, factor: float, digits: int) -> Tile:
        a, b = (side.flights.whole(name).median * factor for side in (old, new))
        return Tile(words, f'{b:.{digits}f}', unit, f'median; before {a:.{digits}f}')

    def over(step: int) -> tuple[float, float]:
        a, b = (100 * side.flights.of(step, 'overshoot').median for side in (old, new))
        return a, b

    climb = over(0)
    held = new.limit.grams
    return [
        both('cost', 'Cost', '', 1.0, 3),
        Tile('Overshoot of a climb', f'{climb[1]:.0f}', '%', f'median; before {climb[0]:.0f}'),
        both('swing', 'Swing at the end', '\N{DEGREE SIGN}', 180.0 / math.pi, 2),
        Tile(
            'Missions at the goal',
            f'{100 * new.flights.reached.value:.0f}',
            '%',
            f'before {told.share(old.flights.reached)}',
        ),
        Tile(
            'Holds up to',
            number(held, 1),
            'g lost',
            f'{new.limit.days[0]:.0f} to {new.limit.days[1]:.0f} days of leaking',
        ),
        Tile(
            'Flights',
            str(len(tuned.found.history) * len(tuned.losses)),
            '',
            f'and {2 * len(old.flights.reports)} to compare',
        ),
    ]


def panels(tuned: Tuned, old: Traces, new: Traces) -> list[str]:
    """Return all pictures."""
    lines = 'Dashed: what is asked. Truth, one line a loss; the more lost, the paler.'
    out = [
        section(channel, heading, f'{caption} {lines}', pictures.responses(channel, old, new))
        for channel, heading, caption in CHANNELS
    ]
    flights = tuned.old.flights, tuned.new.flights
    history = pictures.search(tuned.found.history, len(tuned.losses))
    every = 'Each draw is flown with both.'
    return [
        *out,
        section('costs', 'Cost of each fresh draw', every, pictures.costs(*flights)),
        section(
            'search',
            'The search',
            'Half the mean and half the worst of all cases. Dotted: the gains before.',
            history,
        ),
    ]


def facts(tuned: Tuned) -> dict[str, str]:
    """Return where the numbers come from."""
    order = tuned.order
    return {
        'vehicle': order.vehicle,
        'gains before': tuned.gains_name,
        'losses of the search': ', '.join(f'{1e3 * loss:.2g} g' for loss in tuned.losses),
        'seeds': f'{order.seed} to {order.seed + len(tuned.losses) - 1}; fresh draws from 1000',
        'commit': commit(),
    }


def commands(tuned: Tuned) -> dict[str, str]:
    """Return how to go on."""
    file = str(near(tuned.file))
    return {
        'Fly with them': typed('simulate', '--vehicle', tuned.order.vehicle, '--gains', file),
        'Go on from them': typed('tune', tuned.order.vehicle, '--gains', file),
    }
