"""How far predictions are off under each model, as HTML: whole poses first, then every channel."""

from collections.abc import Sequence
from html import escape
import math
from typing import Final

from lta_discovery.finding import Finding, Gap
from lta_discovery.forecast.replayed import NAMES
from lta_discovery.page import strips
from lta_discovery.page.tables import Row, table
from lta_discovery.page.words import amount, listed, percent

HEADS: Final = (
    'before', 'tuned', 'after', 'coast', 'noise', 'shrinks by', '95 %', 'pieces',
)  # fmt: skip
WHOLE: Final = ('position', 'attitude')
KEY: Final = (
    '<p class="note"><i class="key before"></i>before <i class="key tuned"></i>tuned '
    '<i class="key after"></i>after <i class="key coast"></i>coast '
    '<i class="key noise"></i>noise</p>'
)


def gaps(found: Finding) -> str:
    """Return the errors of position and attitude under all models, horizon by horizon."""
    if not found.gaps:
        return '<p class="note">There was no flight to show the gap on.</p>'
    out = [KEY]
    whole = [gap for gap in found.gaps if gap.channel in WHOLE] or list(found.gaps)
    for channel in dict.fromkeys(gap.channel for gap in whole):
        of = [gap for gap in whole if gap.channel == channel]
        low, high = scale(of)
        rows = [(_ahead(gap), _strip(gap, low, high), *_figures(gap)) for gap in of]
        title = NAMES.get(channel, channel)
        inside = table(('ahead', '', *HEADS), rows, 'plain gaps', f'Errors of {title}')
        out.append(f'<h3>{escape(title.capitalize())}</h3>{inside}')
    return f'{"".join(out)}<p class="note">{escape(_errors_of(found))}</p>'


def by_channel(found: Finding) -> str:
    """Return the same of every single channel; '' where there is none beside the whole."""
    single = [gap for gap in found.gaps if gap.channel not in WHOLE]
    if not single or len(single) == len(found.gaps):
        return ''
    rows = [
        (escape(NAMES.get(gap.channel, gap.channel)), _ahead(gap), *_figures(gap))
        for gap in single
    ]
    inside = table(('channel', 'ahead', *HEADS), rows, 'plain', 'Errors of single channels')
    return (
        '<section class="panel section" aria-labelledby="title-channels">'
        '<h2 id="title-channels">Channel by channel</h2><details><summary>'
        f'Every channel that was measured, at every horizon</summary>{inside}</details></section>'
    )


def _errors_of(found: Finding) -> str:
    """Return what the errors are of."""
    whose = (
        f'on {listed(found.bags.get("holdout", ()))}, to which nothing was fitted'
        if found.held_out
        else 'on flights that had a say in what was found'
    )
    return (
        f'Root mean square {whose}. Tuned: tolerances of the file fitted, without any effect. '
        'Coast: velocity and rates kept, commands ignored. Shaded: the noise of the measurement, '
        'the least that any model can be off by. Intervals by bootstrap over pieces.'
    )


def scale(of: Sequence[Gap]) -> tuple[float, float]:
    """Return the ends of a logarithmic scale that shows all errors of a channel."""
    every = [
        part
        for gap in of
        for part in (gap.before, gap.tuned, gap.after, gap.coast, gap.noise_floor)
        if math.isfinite(part) and part > 0.0
    ]
    return min(every, default=1.0) / 1.3, max(every, default=1.0) * 1.1


def _ahead(gap: Gap) -> str:
    """Return the horizon."""
    return f'{gap.horizon_s:g} s'


def _strip(gap: Gap, low: float, high: float) -> str:
    """Return all models as points on one scale."""
    four = {'coast': gap.coast, 'before': gap.before, 'tuned': gap.tuned, 'after': gap.after}
    return strips.points(four, low, high, gap.noise_floor)


def _figures(gap: Gap) -> Row:
    """Return one channel at one horizon in figures, in the order of HEADS."""
    five = (gap.before, gap.tuned, gap.after, gap.coast, gap.noise_floor)
    a, b = (percent(part) for part in gap.shrink_ci95)
    errors = (amount(part, gap.unit) for part in five)
    return (*errors, f'{percent(gap.shrink)} %', f'{a} to {b} %', str(gap.pieces))
