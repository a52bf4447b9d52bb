# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the headline and the tables of a tuning report, for page and terminal."""

from collections.abc import Sequence
import math
import re
from typing import Final

from lta_report.formatting import format_number
from lta_report.report import TextTable
from lta_report.result_table import format_share
from lta_studies.tune.compare import compare_costs, QuartileSpread, STEP_NAMES
from lta_studies.tune.helium_limit import HeliumLimit
from lta_studies.tune.margins import LoopMargins, StabilityMargins, to_decibels
from lta_studies.tune.run import TuningResult

Row = list[str]
MARGINS_NOTE: Final = (
    'Each loop is opened at its demand with the others closed, using one control '
    'period linearised about the steady flight. Gain: by how much it may fall or rise before the '
    'loop oscillates. Phase and delay: margins at the crossover. Where a swing grows, the '
    'drone is unstable whatever the margins of a single loop.'
)
LIMITS_NOTE: Final = (
    'Relative to the trim of the vehicle file. Held: take-off, a climb of 0.4 m '
    'and a descent, each ending within 0.3 m of the altitude. Days follow from the permeation of '
    'laminates, assumed for this film.'
)
# Field of the metrics, row label, factor to the displayed unit, digits
OF_STEP: Final = (
    ('settle', 'time to settle [s]', 1.0, 1),
    ('overshoot', 'overshoot [%]', 100.0, 0),
    ('steady', 'steady error [%]', 100.0, 0),
)
OF_WHOLE: Final = (
    ('altitude', 'altitude error during the other steps [cm rms]', 100.0, 1),
    ('swing', 'swing at the end [deg]', 180.0 / math.pi, 2),
    ('search', 'duration of the mission [% of the time limit]', 100.0, 0),
    ('growth', 'growth rate of a swing in cruise [%/s]', 100.0, 1),
    ('effort', 'change of duty [1/s]', 1.0, 2),
    ('cost', 'cost', 1.0, 3),
)


def format_headline(tuned: TuningResult) -> str:
    """Return the headline; it claims a difference only if the 95 % interval excludes 0."""
    old, new = tuned.old.flights, tuned.new.flights
    gap = compare_costs(old, new)
    before = sum(report.cost for report in old.reports) / len(old.reports)
    interval = f'95 % interval of the difference: {gap.low:+.3f} to {gap.high:+.3f}'
    # Differences are new - old, so a negative interval means that the new gains are better.
    if gap.high < 0.0:
        less = f'{-100.0 * gap.value / before:.0f} % lower'
        return (
            f'The cost of the new gains is {less} over {len(old.reports)} new random flights '
            f'({interval}).'
        )
    if gap.low > 0.0:
        words = f'over {len(old.reports)} new random flights ({interval})'
        return f'The cost of the new gains is higher {words}: keep the old gains.'
    return (
        f'No significant difference of the cost over {len(old.reports)} new random flights '
        f'({interval}).'
    )


def format_spread(value: QuartileSpread, factor: float = 1.0, digits: int = 2) -> str:
    """Format a median with its quartiles."""

    def format_number(x: float) -> str:
        return 'never' if math.isinf(x) else f'{factor * x:.{digits}f}'

    return (
        f'{format_number(value.median)} '
        f'({format_number(value.low)} to {format_number(value.high)})'
    )


def build_comparison_table(tuned: TuningResult) -> TextTable:
    """Return the table of all metrics with old and new gains."""
    sides = (tuned.old.flights, tuned.new.flights)
    rows = [
        ['mission reached its goal', *(format_share(side.reached_share) for side in sides)],
        ['altitude lost', *(format_share(side.lost_share) for side in sides)],
    ]
    for k, name in enumerate(STEP_NAMES):
        rows.append(
            [f'{name}: settled', *(format_share(side.settling_share(k)) for side in sides)]
        )
        for figure, words, factor, digits in OF_STEP:
            values = (
                format_spread(side.summarize_step(k, figure), factor, digits) for side in sides
            )
            rows.append([f'{name}: {words}', *values])
    for figure, words, factor, digits in OF_WHOLE:
        values = (
            format_spread(side.compute_metric_quartiles(figure), factor, digits) for side in sides
        )
        rows.append([words, *values])
    heads = ('median (quartiles), or share (95 % interval)', 'old', 'new')
    return TextTable('Improvement on new samples', heads, typeset_rows(rows))


def format_margins(margins: StabilityMargins | None) -> tuple[str, str, str]:
    """Format gain margins, phase margin with its crossover, and delay margin."""
    if margins is None:
        return '-', '-', '-'
    up = '∞' if margins.gain is None else f'{to_decibels(margins.gain):+.1f}'
    down = '-∞' if margins.gain_down is None else f'{to_decibels(margins.gain_down):.1f}'
    if margins.phase is None or margins.crossover is None or margins.delay is None:
        return f'{down}, {up}', '-', '-'
    phase = f'{math.degrees(margins.phase):.0f} at {margins.crossover:.2f}'
    return f'{down}, {up}', phase, f'{1e3 * margins.delay:.0f}'


def build_stability_margin_table(tuned: TuningResult) -> TextTable:
    """Return the table of the margins with old and new gains."""
    rows = []
    order = {'altitude': 0, 'heading': 1, 'speed': 2}
    pairs = list(zip(tuned.old.steadiness, tuned.new.steadiness, strict=True))
    # The margins come ordered by loss; the table groups them by loop.
    pairs.sort(key=lambda pair: (order[pair[0].loop], pair[0].speed, pair[0].loss))
    for old, new in pairs:
        if old.margins is None and new.margins is None:
            continue
        rows.append(
            [
                old.loop, f'{old.speed:.1f}', f'{1e3 * old.loss:.1f}',
                *format_margins(old.margins), *format_margins(new.margins),
                explain_missing_margin(old, new),
            ]
        )  # fmt: skip
    margins = ('gain [dB]', 'phase [\N{DEGREE SIGN}] at [rad/s]', 'delay [ms]')
    # The last column holds remarks
    heads = ('loop', 'speed [m/s]', 'lift lost [g]', *margins, *margins, '')
    groups = (('', 3), ('old', 3), ('new', 3), ('', 1))
    return TextTable(
        'Stability margins', heads, typeset_rows(rows), MARGINS_NOTE, groups, printed=False
    )


def explain_missing_margin(old: LoopMargins, new: LoopMargins) -> str:
    """Return why a margin is missing, or which swing is unstable."""
    words = []
    for name, side in (('old', old), ('new', new)):
        if side.margins is None:
            words.append(f'{name}: {side.why}')
        elif not side.stable:
            words.append(
                f'{name}: unstable, an oscillation at {side.swing:.2f} rad/s grows by '
                f'{100 * side.growth:.1f} % per second'
            )
    return '; '.join(words)


def build_helium_limit_table(old: HeliumLimit, new: HeliumLimit) -> TextTable:
    """Return the table of helium limits with old and new gains."""

    def format_limit(value: float | None) -> str:
        return format_number(None if value is None or math.isinf(value) else value, 1)

    rows = [
        [words, *(format_limit(getattr(side, name)) for side in (old, new))]
        for name, words in (
            ('grams', 'largest loss of lift held in flight [g]'),
            ('fails', 'smallest loss of lift that failed in flight [g]'),
            ('demand', 'loss of lift that the largest vertical command carries [g]'),
            ('rotors', 'loss of lift that full thrust carries [g]'),
        )
    ]
    leak = 'days to lose what was held, at a leak of 0.2 to 0.9 L/(m² day)'
    rows.append([leak, format_leak_days(old), format_leak_days(new)])
    return TextTable('Limits of the gains', ('', 'old', 'new'), rows, LIMITS_NOTE)


def format_leak_days(limit: HeliumLimit) -> str:
    """Format the range of days until that much has leaked."""
    return f'{limit.days[0]:.0f} to {limit.days[1]:.0f}'


def build_parameter_table(tuned: TuningResult) -> TextTable:
    """Return the table of tuned parameters: path, old, new, search bounds."""
    rows = []
    for each in tuned.numbers:
        new: object = tuned.new.gains
        # A path like 'climb.kp' leads through nested settings.
        for name in each.path.split('.'):
            new = getattr(new, name)
        low, high = each.search_bounds()
        rows.append([each.path, f'{each.value:g}', f'{new:g}', f'{low:.3g} to {high:.3g}'])
    heads = ('number', 'old', 'new', 'searched')
    return TextTable('Gains', heads, typeset_rows(rows), printed=False)


def typeset_rows(rows: Sequence[Row]) -> list[Row]:
    """Typeset the signs of all cells."""
    return [[typeset_signs(cell) for cell in row] for row in rows]


def typeset_signs(text: str) -> str:
    """Replace hyphens by minus signs and 'deg' by the degree sign."""
    # A hyphen before a number and not after a word character: 'a-1' keeps its hyphen.
    text = re.sub(r'(?<!\w)-(?=[\d∞])', '\N{MINUS SIGN}', text)
    return text.replace(' deg', '\N{DEGREE SIGN}').replace('[deg]', '[\N{DEGREE SIGN}]')
