"""A tuning in words and tables, for the page and for the terminal."""

from collections.abc import Sequence
from html import escape
import math
import re
from typing import Final

from lta_flight.sweep.statistics import Share
from lta_report.formatting import number
from lta_studies.tune.compare import difference, NAMES, Spread
from lta_studies.tune.limit import HeliumLimit
from lta_studies.tune.margins import decibel, Margins
from lta_studies.tune.run import Tuned
from lta_studies.tune.steadiness import Steadiness

Row = list[str]
OF_STEP: Final = (
    ('settle', 'time to settle [s]', 1.0, 1),
    ('overshoot', 'overshoot [%]', 100.0, 0),
    ('steady', 'steady error [%]', 100.0, 0),
)
OF_WHOLE: Final = (
    ('altitude', 'altitude held meanwhile [cm rms]', 100.0, 1),
    ('swing', 'swing at the end [deg]', 180.0 / math.pi, 2),
    ('search', 'time of the mission [% of the limit]', 100.0, 0),
    ('growth', 'growth of a swing in cruise [%/s]', 100.0, 1),
    ('effort', 'change of duty [1/s]', 1.0, 2),
    ('cost', 'cost', 1.0, 3),
)


def title(tuned: Tuned) -> str:
    """Return what came out, in a sentence that the fresh draws bear."""
    old, new = tuned.old.flights, tuned.new.flights
    gap = difference(old, new)
    before = sum(report.cost for report in old.reports) / len(old.reports)
    interval = f'difference {gap.low:+.3f} to {gap.high:+.3f}'
    if gap.high < 0.0:
        less = f'{-100.0 * gap.mean / before:.0f} % less'
        return f'The new gains cost {less} over {len(old.reports)} fresh draws ({interval}).'
    if gap.low > 0.0:
        words = f'over {len(old.reports)} fresh draws ({interval})'
        return f'The new gains are worse {words}: keep the old.'
    return f'No difference that {len(old.reports)} fresh draws could tell ({interval}).'


def share(value: Share) -> str:
    """Return a share with its interval."""
    return f'{100 * value.value:.0f} % ({100 * value.low:.0f} to {100 * value.high:.0f})'


def spread(value: Spread, factor: float = 1.0, digits: int = 2) -> str:
    """Return a median with its middle half."""

    def told(x: float) -> str:
        return 'never' if math.isinf(x) else f'{factor * x:.{digits}f}'

    return f'{told(value.median)} ({told(value.low)} to {told(value.high)})'


def robust_rows(tuned: Tuned) -> list[Row]:
    """Return what it bought: figure, old, new."""
    sides = (tuned.old.flights, tuned.new.flights)
    rows = [
        ['mission at its goal', *(share(side.reached) for side in sides)],
        ['altitude lost', *(share(side.lost) for side in sides)],
    ]
    for k, name in enumerate(NAMES):
        rows.append([f'{name}: settled', *(share(side.settled(k)) for side in sides)])
        for figure, words, factor, digits in OF_STEP:
            values = (spread(side.of(k, figure), factor, digits) for side in sides)
            rows.append([f'{name}: {words}', *values])
    for figure, words, factor, digits in OF_WHOLE:
        values = (spread(side.whole(figure), factor, digits) for side in sides)
        rows.append([words, *values])
    return rows


def margin_words(found: Margins | None) -> tuple[str, str, str]:
    """Return gain margins, phase margin with its crossover, and delay margin."""
    if found is None:
        return '-', '-', '-'
    up = '∞' if found.gain is None else f'{decibel(found.gain):+.1f}'
    down = '-∞' if found.gain_down is None else f'{decibel(found.gain_down):.1f}'
    if found.phase is None or found.crossover is None or found.delay is None:
        return f'{down}, {up}', '-', '-'
    phase = f'{math.degrees(found.phase):.0f} at {found.crossover:.2f}'
    return f'{down}, {up}', phase, f'{1e3 * found.delay:.0f}'


MARGIN_HEADS = (
    'loop', 'speed [m/s]', 'lift lost [g]',
    'old: gain [dB]', 'phase [deg] at [rad/s]', 'delay [ms]',
    'new: gain [dB]', 'phase [deg] at [rad/s]', 'delay [ms]', '',
)  # fmt: skip


def margin_rows(tuned: Tuned) -> list[Row]:
    """Return the margins of old and new side by side."""
    rows = []
    order = {'altitude': 0, 'heading': 1, 'speed': 2}
    pairs = list(zip(tuned.old.steadiness, tuned.new.steadiness, strict=True))
    pairs.sort(key=lambda pair: (order[pair[0].loop], pair[0].speed, pair[0].loss))
    for old, new in pairs:
        if old.margins is None and new.margins is None:
            continue
        rows.append(
            [
                old.loop, f'{old.speed:.1f}', f'{1e3 * old.loss:.1f}',
                *margin_words(old.margins), *margin_words(new.margins),
                remark(old, new),
            ]
        )  # fmt: skip
    return rows


def remark(old: Steadiness, new: Steadiness) -> str:
    """Return what the numbers do not say."""
    words = []
    for name, side in (('old', old), ('new', new)):
        if side.margins is None:
            words.append(f'{name}: {side.why}')
        elif not side.stable:
            words.append(
                f'{name}: a swing of {side.swing:.2f} rad/s grows by {100 * side.growth:.1f} %/s'
            )
    return '; '.join(words)


def limit_rows(old: HeliumLimit, new: HeliumLimit) -> list[Row]:
    """Return where gains stop holding: figure, old, new."""

    def told(value: float | None) -> str:
        return number(None if value is None or math.isinf(value) else value, 1)

    return [
        ['held, flown [g lost]', told(old.grams), told(new.grams)],
        ['lost, flown [g lost]', told(old.fails), told(new.fails)],
        ['largest demand carries [g lost]', told(old.demand), told(new.demand)],
        ['rotors carry [g lost]', told(old.rotors), told(new.rotors)],
        ['days, by 0.2 to 0.9 L/(m² day)', days(old), days(new)],
    ]


def days(limit: HeliumLimit) -> str:
    """Return how long it takes to leak that much."""
    return f'{limit.days[0]:.0f} to {limit.days[1]:.0f}'


def gain_rows(tuned: Tuned) -> list[Row]:
    """Return what was turned: path, old, new, ends of the search."""
    out = []
    for each in tuned.numbers:
        new: object = tuned.new.gains
        for name in each.path.split('.'):
            new = getattr(new, name)
        low, high = each.ends()
        out.append([each.path, f'{each.value:g}', f'{new:g}', f'{low:.3g} to {high:.3g}'])
    return out


def typeset(text: str) -> str:
    """Return plain words with true minus signs and degrees."""
    text = re.sub(r'(?<!\w)-(?=[\d∞])', '\N{MINUS SIGN}', text)
    return text.replace(' deg', '\N{DEGREE SIGN}').replace('[deg]', '[\N{DEGREE SIGN}]')


def table(heads: Sequence[str], rows: Sequence[Row], text: bool = False) -> str:
    """Return rows as a table; with `text`, the last column is words."""
    head = ''.join(f'<th scope="col">{escape(typeset(cell))}</th>' for cell in heads)
    lines = []
    for first, *rest in rows:
        cells = [f'<td>{escape(typeset(cell))}</td>' for cell in rest]
        if text:
            cells[-1] = f'<td class="text">{escape(typeset(rest[-1]))}</td>'
        lines.append(f'<tr><th scope="row">{escape(typeset(first))}</th>{"".join(cells)}</tr>')
    return (
        f'<table class="numbers"><thead><tr>{head}</tr></thead>'
        f'<tbody>{"".join(lines)}</tbody></table>'
    )
