"""What a study says, as HTML that needs no script: effects, ladder, gaps, places, remains."""

from collections.abc import Sequence
from html import escape
import math
from typing import Final

from lta_discovery.conclusion import draw_conclusion, is_still_named
from lta_discovery.finding import Finding, Learned, NamedEffect, Place, Rung
from lta_discovery.forecast.replayed import NAMES
from lta_discovery.naming.accept import GAIN
from lta_discovery.outside.unexplained import Remainder
from lta_discovery.page import strips
from lta_discovery.page.verdict_words import format_advice
from lta_discovery.page.words import (
    because,
    called,
    figure,
    format_assumed,
    held_words,
    listed,
    meaning,
    odds,
    percent,
    remainder_words,
    size_unit,
    spoken,
    with_unit,
    within,
)

Row = Sequence[str]
MOST: Final = 6  # places that are not folded
BLIND: Final = ' class="blind"'


def table(heads: Row, rows: Sequence[Row], name: str, caption: str) -> str:
    """
    Return a table; the first cell of a row is its heading.

    Parameters
    ----------
    heads : sequence of str
        Of the columns; plain text.
    rows : sequence of sequences of str
        HTML.
    name : str
        Its class.
    caption : str
        For those who listen.

    """
    head = ''.join(f'<th scope="col">{escape(each)}</th>' for each in heads)
    body = ''.join(
        f'<tr><th scope="row">{row[0]}</th>{"".join(f"<td>{cell}</td>" for cell in row[1:])}</tr>'
        for row in rows
    )
    return (
        f'<div class="wide" tabindex="0" role="region" aria-label="{escape(caption)}">'
        f'<table class="{name}"><caption class="hidden">{escape(caption)}</caption>'
        f'<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
    )


def effects(found: Finding) -> str:
    """Return what is missing, effect by effect; what it would have taken where nothing is."""
    if found.effects:
        return ''.join(map(_effect, found.effects))
    return f'<p class="calm">{escape(_nothing(found))}</p>'


def _nothing(found: Finding) -> str:
    """Return in a few sentences that nothing has a name, and what that means."""
    tried = [rung for step in found.ladder for rung in step]
    best = max(tried, key=lambda rung: rung.total, default=None)
    near = (
        'No candidate looked worth a refit.'
        if best is None
        else f'The best candidate was {spoken(best.knob)}, with {figure(best.total)} nats where '
        f'{GAIN:g} make a name: {because(best, beaten=False, stands=False)}.'
    )
    said = {
        'none': 'The vehicle file explains these flights to within its own tolerances and the '
        'noise.'
        if draw_conclusion(found).fits
        else 'No candidate was confirmed by all flights.',
        'not_identifiable': 'What is missing, or whether anything is, cannot be told from these '
        'flights, so nothing is named.',
    }.get(
        found.verdict,
        'A force or moment is left over that no effect of the library explains on both flights. '
        'It is described below, not named.',
    )
    return f'{said} {near}'


def detectable(found: Finding) -> str:
    """Return how small an effect could have been seen, the clearest first; '' if nobody asked."""
    if not found.detectable:
        return ''
    ordered = sorted(found.detectable, key=lambda one: one.size / (one.typical or math.inf))
    clear = sum(one.size < one.typical for one in ordered)
    rows = ''.join(
        f'<li{"" if one.size < one.typical else BLIND}><span>{escape(spoken(one.knob))}</span> '
        f'<b>{escape(with_unit(figure(one.size, 2), one.unit))}</b></li>'
        for one in ordered
    )
    return (
        '<section class="panel section" aria-labelledby="title-seen">'
        '<h2 id="title-seen">How small an effect could have been seen</h2>'
        f'<details{"" if found.effects else " open"}><summary>{len(ordered)} candidates</summary>'
        f'<p class="note">From this size on it would have been named, 19 times in 20, if nothing '
        f'else were missing. {clear} of {len(ordered)} would have been seen below their typical '
        'size; the others (in italics) only if they were larger than usual.</p>'
        f'<ul class="seen">{rows}</ul></details></section>'
    )


def _effect(one: NamedEffect) -> str:
    """Return one named effect."""
    names = called(one)
    alike = (
        f'<p class="note">These flights cannot tell it from <b>'
        f'{escape(listed([spoken(knob) for knob in one.confusable_with], "or"))}</b>.</p>'
        if one.confusable_with
        else '<p class="note">No other effect of the library looks like it on these flights.</p>'
    )
    return (
        f'<div class="effect"><h3>{escape(names[:1].upper() + names[1:])}</h3>'
        f'<p class="what">{escape(meaning(one.name))}</p>'
        f'{"".join(map(_parameter, one.parameters))}{_assumed(one)}'
        f'<p class="note">Without it the flights lose <b>{figure(one.log_evidence)} nats</b> of '
        f'evidence, {odds(one.log_evidence)} against that nothing is missing.</p>{alike}</div>'
    )


def _assumed(one: NamedEffect) -> str:
    """Return on which assumed numbers the values of an effect depend."""
    said = format_assumed(one).strip()
    return f'<p class="note">Its values hold {escape(said)}.</p>' if said else ''


def _parameter(one: Learned) -> str:
    """Return one parameter with its interval."""
    value, low, high = within(one.value, one.ci95)
    before = one.before if one.in_file else math.nan
    return (
        f'<dl class="learned"><dt>{escape(one.name.replace("_", " "))}</dt>'
        f'<dd><b>{value}</b> {escape(with_unit("", one.unit).strip())} '
        f'<small>95 %: {low} to {high}; {held_words(one)}</small></dd></dl>'
        f'{strips.interval(before, one.value, one.ci95)}'
    )


def ladder(found: Finding) -> str:
    """Return all candidates round by round."""
    rungs = [rung for step in found.ladder for rung in step]
    if not rungs:
        return '<p class="absent">No candidate looked worth a refit.</p>'
    most = max(GAIN * 1.6, *(rung.total for rung in rungs))
    out = []
    for k, step in enumerate(found.ladder, 1):
        named = next((rung for rung in step if rung.accepted), None)
        words = 'nothing is confirmed'
        if named is not None:
            kept = is_still_named(found, named.knob)
            words = f'{spoken(named.knob)} is named{"" if kept else ", and given up at the end"}'
        out.append(f'<h3>Round {k}: {escape(words)}</h3>')
        heads = ('candidate', 'evidence', 'train', 'confirm', 'carried', 'apart', 'because')
        if not step:
            out.append('<p class="note">No candidate looked worth a refit.</p>')
            continue
        rows = [
            _rung(rung, most, named is not None, is_still_named(found, rung.knob)) for rung in step
        ]
        out.append(table(heads, rows, 'plain ladder', f'Candidates of round {k}'))
    return ''.join(out)


def _rung(rung: Rung, most: float, beaten: bool, stands: bool) -> Row:
    """Return one candidate."""
    name = escape(spoken(rung.knob))
    return (
        f'<b>{name}</b>' if rung.accepted and stands else name,
        strips.stacked(rung.train, max(rung.confirm, rung.carried), GAIN, most),
        *(figure(part) for part in (rung.train, rung.confirm, rung.carried)),
        figure(rung.apart, 2),
        because(rung, beaten, stands),
    )


def places(found: Finding) -> str:
    """Return where the model disagrees most, the largest first."""
    if not found.where:
        return '<p class="absent">Nowhere does the error stand out from the noise.</p>'
    most = max(place.ratio_to_noise for place in found.where)
    rows = [_place(place, most) for place in found.where]
    heads = ('when', 'by the noise', '', 'channel', 'flight', 'from', 'to')
    first, rest = (
        table(heads, part, 'plain places', 'Where the model disagrees most') if part else ''
        for part in (rows[:MOST], rows[MOST:])
    )
    more = f'<details><summary>{len(rows) - MOST} more</summary>{rest}</details>' if rest else ''
    return first + more


def _place(place: Place, most: float) -> Row:
    """Return one place."""
    return (
        escape(place.condition),
        figure(place.ratio_to_noise),
        strips.bar(place.ratio_to_noise, most),
        escape(NAMES.get(place.channel, place.channel)),
        escape(place.flight),
        f'{figure(place.from_s)} s',
        f'{figure(place.to_s)} s',
    )


def remains(found: Finding) -> str:
    """Return what no effect explains, the largest first."""
    if not found.remains:
        return ''
    most = max(one.floors for one in found.remains)
    rows = [_remainder(one, most) for one in found.remains]
    heads = ('axis', 'by the floor', '', 'size', 'what it is', 'carries over')
    return table(heads, rows, 'plain remains', 'What no effect of the library explains')


def _remainder(one: Remainder, most: float) -> Row:
    """Return what remains on one axis."""
    said = remainder_words(one)
    return (
        one.axis,
        figure(one.floors),
        strips.bar(one.floors, most),
        f'{figure(one.size)} {size_unit(one)}',
        escape(said),
        f'{percent(one.carried)} %',
    )


def unexplained(found: Finding) -> str:
    """Return in sentences what no effect explains, with lines of the spectrum, and a draught."""
    told = [*found.unexplained, *([found.draught.sentence] if found.draught else [])]
    if not told:
        return ''
    rows = ''.join(f'<li>{escape(said[:1].upper() + said[1:])}.</li>' for said in told)
    return f'<ul class="words">{rows}</ul>'


def following(found: Finding) -> str:
    """Return what to do with the vehicle file, and what to fly or measure next."""
    said = f'{format_advice(found)} {found.next_flight}'.strip()
    return (
        '<section class="panel" aria-labelledby="title-following">'
        f'<h2 id="title-following">What to do next</h2>'
        f'<p class="what">{escape(said)}</p></section>'
    )


def warned(found: Finding) -> str:
    """Return the warnings as a list, or that there are none."""
    if not found.warnings:
        doubt = '.' if draw_conclusion(found).doubtful else ': the data gave no cause for doubt.'
        return f'<p class="note">None{doubt}</p>'
    return f'<ul class="words">{"".join(f"<li>{escape(one)}</li>" for one in found.warnings)}</ul>'
