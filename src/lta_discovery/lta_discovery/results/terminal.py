"""What was found, on the terminal."""

from collections.abc import Iterator
import math
from typing import Final

from lta_discovery.finding import Carried, Finding, Gap
from lta_discovery.forecast.replayed import NAMES
from lta_discovery.page.verdict_words import format_advice, headline
from lta_discovery.page.words import (
    amount,
    figure,
    format_assumed,
    held_words,
    listed,
    percent,
    with_unit,
    within,
)
from lta_discovery.results.discovery_json import horizon
from lta_model.effects.protocol import AXES
from rich.console import Console
from rich.table import Table
from rich.text import Text

BAR: Final = 32  # characters
BARS: Final = (
    ('coast', 'ignoring the commands', 'dim'),
    ('before', 'the vehicle file', 'red'),
    ('tuned', 'its tolerances tuned', 'yellow'),
    ('after', 'with what was found', 'green'),
    ('noise_floor', 'the tracker itself', 'dim'),
)
WHOLE: Final = ('position', 'attitude')
MOST: Final = 8  # places that are told


def show(finding: Finding, console: Console) -> None:
    """Print the verdict, the effects with their intervals, the gap, and where it was."""
    console.print(Text(headline(finding), 'bold'), soft_wrap=True)
    for said in effect_lines(finding):
        console.print(Text(said), soft_wrap=True)
    if finding.carried is not None:
        console.print(Text(carried_words(finding.carried)), soft_wrap=True)
    for line in gap_lines(finding):
        console.print(line, soft_wrap=True)
    if finding.where:
        console.print(where_table(finding))
    for said in finding.unexplained:
        console.print(Text(f'Unexplained: {said}.'), soft_wrap=True)
    if finding.draught is not None:
        said = finding.draught.sentence
        console.print(Text(f'{said[:1].upper()}{said[1:]}.'), soft_wrap=True)
    console.print(Text(f'{format_advice(finding)} {finding.next_flight}'.strip()), soft_wrap=True)
    for word in finding.warnings:
        console.print(Text(word, 'yellow'), soft_wrap=True)


def found_words(finding: Finding) -> str:
    """Return what was found as short as what was hidden is told."""
    return listed(
        [
            f'{effect.name}.{one.name} = {with_unit(figure(one.value), one.unit)}'
            for effect in finding.effects
            for one in effect.parameters
        ]
        or ['nothing']
    )


def carried_words(carried: Carried) -> str:
    """Return what names by forecasts rest on, in a sentence."""
    ratios = [one.ratio for one in carried.regimes]
    better = sum(ratio < 1.0 for ratio in ratios)
    return (
        f'Named by forecasts: left out of the fit, {better} of {len(ratios)} regimes are '
        f'predicted better than by the vehicle file (error '
        f'{min(ratios):.2f} to {max(ratios):.2f} of its).'
    )


def _table(*heads: tuple[str, str]) -> Table:
    """Return an empty table without frames."""
    table = Table(box=None, pad_edge=False, header_style='dim')
    for head, side in heads:
        # A name that is cut short is no name: it goes on in the next line.
        table.add_column(head, justify=side, overflow='fold')  # type: ignore[arg-type]
    return table


def effect_lines(finding: Finding) -> Iterator[str]:
    """Yield the named effects, a line each, and a line for each parameter: lines are not cut."""
    for one in finding.effects:
        rivals = listed(one.confusable_with, 'or')
        instead = f'; it may be {rivals} instead' if rivals else ''
        yield f'{one.name}: {figure(one.log_evidence)} nats{instead}'
        for each in one.parameters:
            now, low, high = within(each.value, each.ci95)
            yield (
                f'  {each.name} {with_unit(now, each.unit)} '
                f'(95 %: {low} to {high}; {held_words(each)})'
            )
        if one.assumed:
            yield f'  These values hold{format_assumed(one)}.'


def gap_lines(finding: Finding) -> Iterator[Text]:
    """Yield headings and bars: how far predictions are off, for each of the models."""
    at = horizon(finding.gaps)
    for one in finding.gaps:
        if one.horizon_s == at and one.channel in WHOLE:
            seen = 'on flights nothing was fitted to' if finding.held_out else 'not held out'
            sign, word = (1.0, 'less') if one.shrink >= 0.0 else (-1.0, 'more')
            low, high = (percent(part) for part in sorted(sign * end for end in one.shrink_ci95))
            yield Text(
                f'Off in {one.channel} after {at:g} s, {seen}: {percent(sign * one.shrink)} % '
                f'{word} ({low} to {high} %)'
            )
            yield from _bars(one)


def _bars(one: Gap) -> Iterator[Text]:
    """Yield a bar for each model."""
    # What ignores the commands may be off by a room; its bar is cut then.
    most = max(one.before, one.tuned, one.after, 1e-12)
    for key, label, style in BARS:
        size = getattr(one, key)
        share = min(size / most, 1.0) if math.isfinite(size) else 0.0
        bar = '█' * round(BAR * share) + ('>' if size > most else '')
        yield Text(f'  {label:22}{amount(size, one.unit):>9}  ').append(bar, style)


def where_table(finding: Finding) -> Table:
    """Return the places where the model of the vehicle file disagrees most."""
    table = _table(
        ('where', 'left'), ('flight', 'left'), ('from', 'right'), ('to', 'right'),
        ('when', 'left'), ('x noise', 'right'),
    )  # fmt: skip
    forces = [place for place in finding.where if place.channel in AXES]
    others = [place for place in finding.where if place.channel not in AXES]
    for place in [*forces, *others][:MOST]:
        table.add_row(
            NAMES.get(place.channel, place.channel), place.flight, f'{place.from_s:.0f} s',
            f'{place.to_s:.0f} s', place.condition, f'{place.ratio_to_noise:.1f}',
        )  # fmt: skip
    return table
