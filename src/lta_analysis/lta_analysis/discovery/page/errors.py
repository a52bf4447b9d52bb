"""How far predictions are off under each model, as HTML: whole poses first, then every channel."""

from collections.abc import Sequence
from html import escape
import math
from typing import Final

from lta_analysis.discovery.finding import Finding, Gap
from lta_analysis.discovery.page import strips
from lta_analysis.discovery.page.replayed import NAMES
from lta_analysis.discovery.page.tables import Row, table
from lta_analysis.discovery.page.words import amount, listed, percent

WHOLE: Final = ('position', 'attitude')
KEY: Final = (
    '<p class="note"><i class="key before"></i>before <i class="key tuned"></i>tuned '
    '<i class="key after"></i>after <i class="key coast"></i>coast '
    '<i class="key noise"></i>noise</p>'
)


def gaps(found: Finding) -> str:
    """Return the errors of all models, channel by channel and horizon by horizon."""
    if not found.gaps:
        return '<p class="note">There was no flight to show the gap on.</p>'
    return f'{KEY}{_channels(found, whole=True)}<p class="note">{escape(_errors_of(found))}</p>'


def by_channel(found: Finding) -> str:
    """Return the same of every single channel; '' where there is none."""
    inside = _channels(found, whole=False)
    if not inside:
        return ''
    return (
        '<section class="panel section" aria-labelledby="title-channels">'
        '<h2 id="title-channels">Channel by channel</h2><details><summary>'
        f'Every channel that was measured, at every horizon</summary>{KEY}'
        f'<div class="channels">{inside}</div></details></section>'
    )


def _channels(found: Finding, whole: bool) -> str:
    """Return the errors of position and attitude, or of single channels."""
    out = []
    names = dict.fromkeys(gap.channel for gap in found.gaps if (gap.channel in WHOLE) == whole)
    for channel in names:
        of = [gap for gap in found.gaps if gap.channel == channel]
        low, high = scale(of)
        rows = [_gap(gap, low, high) for gap in of]
        heads = (
            'ahead', '', 'before', 'tuned', 'after', 'coast', 'noise', 'shrinks by', '95 %',
            'pieces',
        )  # fmt: skip
        title = NAMES.get(channel, channel)
        inside = table(heads, rows, 'plain gaps', f'Errors of {title}')
        out.append(f'<div><h3>{escape(title.capitalize())}</h3>{inside}</div>')
    return ''.join(out)


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


def _gap(gap: Gap, low: float, high: float) -> Row:
    """Return one channel at one horizon."""
    four = {'coast': gap.coast, 'before': gap.before, 'tuned': gap.tuned, 'after': gap.after}
    a, b = (percent(part) for part in gap.shrink_ci95)
    return (
        f'{gap.horizon_s:g} s',
        strips.points(four, low, high, gap.noise_floor),
        *(amount(part, gap.unit)
          for part in (gap.before, gap.tuned, gap.after, gap.coast, gap.noise_floor)),
        f'{percent(gap.shrink)} %',
        f'{a} to {b} %',
        str(gap.pieces),
    )  # fmt: skip
