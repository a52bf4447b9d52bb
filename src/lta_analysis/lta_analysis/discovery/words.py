"""What was found, for people: on the terminal."""

from collections.abc import Iterator
from typing import Final

from lta_analysis.discovery.finding import Finding, Gap, Learned, NamedEffect
from lta_analysis.discovery.told import horizon
from rich.console import Console
from rich.table import Table
from rich.text import Text

BAR: Final = 32  # characters
BARS: Final = (
    ('coast', 'what ignores the commands', 'dim'),
    ('before', 'the vehicle file', 'red'),
    ('tuned', 'its tolerances tuned', 'yellow'),
    ('after', 'with what was found', 'green'),
    ('noise_floor', 'the tracker itself', 'dim'),
)
MOST: Final = 6  # places that are told
SCALES: Final = {'m': (1e3, 'mm'), 'rad': (57.29577951308232, 'deg')}


def sentence(finding: Finding) -> str:
    """Return the verdict as a sentence."""
    names = _listed([_spoken(effect) for effect in finding.effects])
    rest = _listed([f'{one.axis} ({one.floors:.0f} floors)' for one in finding.remains])
    missing = f'Missing in {finding.vehicle}: {names}.'
    return {
        'none': f'Nothing is missing in {finding.vehicle}, as far as these flights can tell.',
        'named': missing,
        'unexplained': f'Something is missing that no effect of the library explains: {rest}.',
        'named+unexplained': f'{missing} More is missing, which no effect explains: {rest}.',
        'not_identifiable': 'These flights cannot tell what is missing, if anything is.',
    }[finding.verdict].replace(': .', '.')


def _spoken(effect: NamedEffect) -> str:
    """Return a named effect with what it could be as well."""
    also = f' (or {_listed(effect.confusable_with, "or")})' if effect.confusable_with else ''
    return f'{effect.name}{also}'


def _listed(words: list[str] | tuple[str, ...], last: str = 'and') -> str:
    """Return words as a list in a sentence."""
    *others, final = words or ('',)
    return f'{", ".join(others)} {last} {final}' if others else final


def show(finding: Finding, console: Console) -> None:
    """Print verdict, effects, gap and where."""
    console.print(Text(sentence(finding), 'bold'), soft_wrap=True)
    if finding.effects:
        console.print(effects_table(finding))
    for line in gap_lines(finding):
        console.print(line, soft_wrap=True)
    if finding.where:
        console.print(where_table(finding))
    for word in finding.warnings:
        console.print(Text(word, 'yellow'), soft_wrap=True)


def effects_table(finding: Finding) -> Table:
    """Return the named effects, a row a parameter."""
    table = Table(box=None, pad_edge=False, header_style='dim')
    for head, side in (
        ('effect', 'left'), ('parameter', 'left'), ('before', 'right'), ('now', 'right'),
        ('95 %', 'right'), ('', 'left'), ('nats', 'right'),
    ):  # fmt: skip
        table.add_column(head, justify=side)  # type: ignore[arg-type]
    for effect in finding.effects:
        for k, one in enumerate(effect.parameters):
            first = (effect.name, f'{effect.log_evidence:.0f}') if k == 0 else ('', '')
            table.add_row(first[0], *_row(one), first[1])
    return table


def _row(one: Learned) -> tuple[str, ...]:
    """Return a parameter in words."""
    low, high = one.ci95
    unit = '' if one.unit == '1' else one.unit
    between = f'{low:.3g} to {high:.3g}'
    return one.name, f'{one.before:.3g}', f'{one.value:.3g}', between, unit


def gap_lines(finding: Finding) -> Iterator[Text]:
    """Yield a heading and bars: how far predictions are off, for each of the models."""
    at = horizon(finding.gaps)
    for one in finding.gaps:
        if one.horizon_s != at or one.unit not in SCALES or one.channel not in (
            'position', 'attitude',
        ):  # fmt: skip
            continue
        low, high = one.shrink_ci95
        seen = 'flights nothing was fitted to' if finding.held_out else 'the flights themselves'
        yield Text(
            f'Off in {one.channel} after {one.horizon_s:g} s, on {seen}: '
            f'{100.0 * one.shrink:.0f} % less ({100.0 * low:.0f} to {100.0 * high:.0f} %)'
        )
        yield from _bars(one)


def _bars(one: Gap) -> Iterator[Text]:
    """Yield a bar for each model."""
    factor, unit = SCALES[one.unit]
    sizes = {key: getattr(one, key) for key, _, _ in BARS}
    # Whatever ignores the commands may be off by a room; its bar is cut then.
    most = max(sizes['before'], sizes['tuned'], sizes['after'], 1e-12)
    for key, label, style in BARS:
        share = min(sizes[key] / most, 1.0) if sizes[key] == sizes[key] else 0.0
        over = '>' if sizes[key] > most else ''
        line = Text(f'  {label:26}{factor * sizes[key]:9.3g} {unit:4}')
        yield line.append('█' * round(BAR * share) + over, style)


def where_table(finding: Finding) -> Table:
    """Return the places where the model of the vehicle file disagrees most."""
    table = Table(box=None, pad_edge=False, header_style='dim')
    for head in ('where', 'flight', 'from', 'to', 'when'):
        table.add_column(head)
    table.add_column('x noise', justify='right')
    for place in finding.where[:MOST]:
        table.add_row(
            place.channel, place.flight, f'{place.from_s:.0f} s', f'{place.to_s:.0f} s',
            place.condition, f'{place.ratio_to_noise:.1f}',
        )  # fmt: skip
    return table
