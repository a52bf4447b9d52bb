"""Render a study's tables as HTML: effects, search rounds, discrepancies, remaining forces."""

from collections.abc import Sequence
from html import escape
import math
from typing import Final

from lta_discovery.conclusion import draw_conclusion, is_still_named
from lta_discovery.finding import (
    Discrepancy,
    NamedEffect,
    ParameterEstimate,
    SearchCandidate,
    StudyResult,
)
from lta_discovery.forecast.flight_prediction import NAMES
from lta_discovery.page import strips
from lta_discovery.page.formatting import (
    append_unit,
    explain_decision,
    explain_effect,
    format_assumed,
    format_effect,
    format_file_value,
    format_number,
    format_odds,
    format_parameter,
    format_percent,
    format_remainder,
    format_with_interval,
    join_words,
    remainder_unit,
)
from lta_discovery.page.verdict_text import format_advice
from lta_discovery.selection.candidate_acceptance import GAIN
from lta_discovery.unmodeled.unexplained_force import Remainder

Row = Sequence[str]
MOST: Final = 6  # discrepancies shown unfolded
BLIND: Final = ' class="blind"'


def render_table(heads: Row, rows: Sequence[Row], name: str, caption: str) -> str:
    """
    Return a table; the first cell of a row is its heading.

    `heads`: of the columns; plain text.
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


def render_effects(finding: StudyResult) -> str:
    """Return the named effects, or why there are none."""
    if finding.effects:
        return ''.join(map(_render_effect, finding.effects))
    return f'<p class="calm">{escape(_format_nothing_named(finding))}</p>'


def _format_nothing_named(finding: StudyResult) -> str:
    """Explain why no effect was named."""
    tried = [rung for step in finding.ladder for rung in step]
    best = max(tried, key=lambda rung: rung.total, default=None)
    near = (
        'No candidate was promising enough for a full fit.'
        if best is None
        else f'The best candidate was {format_parameter(best.knob)}, with evidence of '
        f'{format_number(best.total)} nats ({GAIN:g} are required). It was rejected for this '
        f'reason: {explain_decision(best, beaten=False)}.'
    )
    text = {
        'none': 'The vehicle file explains these flights to within its own tolerances and the '
        'noise.'
        if draw_conclusion(finding).fits
        else 'No candidate was confirmed by all flights.',
        'not_identifiable': 'These flights do not show what is missing, or whether anything is, '
        'so no effect is named.',
    }.get(
        finding.verdict,
        'A force or moment remains that no effect of the library explains in both the training '
        'and the confirming flights. It is described below.',
    )
    return f'{text} {near}'


def render_detection_limits(finding: StudyResult) -> str:
    """Return the detection limits of the effects, the lowest first; '' if not computed."""
    if not finding.detectable:
        return ''
    # Relative to the typical size; candidates without one come first
    ordered = sorted(finding.detectable, key=lambda one: one.size / (one.typical or math.inf))
    clear = sum(one.size < one.typical for one in ordered)
    rows = ''.join(
        f'<li{"" if one.size < one.typical else BLIND}>'
        f'<span>{escape(format_parameter(one.knob))}</span> '
        f'<b>{escape(append_unit(format_number(one.size, 2), one.unit))}</b></li>'
        for one in ordered
    )
    return (
        f'<details{"" if finding.effects else " open"}><summary>{len(ordered)} '
        f'candidates</summary>'
        f'<p class="note">An effect of this size is named in 19 of 20 cases if nothing '
        f'else is missing. {clear} of {len(ordered)} are detectable below their typical '
        'size; the others (in italics) only if they are larger than usual.</p>'
        f'<ul class="seen">{rows}</ul></details>'
    )


def render_flight_information(finding: StudyResult) -> str:
    """Return which flight informs which number; '' if it is unknown."""
    if not finding.information:
        return ''
    rows = [
        (
            escape(format_parameter(one.knob)),
            f'{format_percent(one.remaining)} %',
            escape(', '.join(f'{f.flight} {format_percent(f.share)} %' for f in one.flights)),
        )
        for one in finding.information
    ]
    heads = ('number', 'deviation left', 'flights, with their share of the information')
    return (
        '<p class="note">The standard deviation that is left of the one before the flights, for '
        'the numbers of the vehicle that these flights inform best.</p>'
        f'{render_table(heads, rows, "plain", "Information of each flight")}'
    )


def _render_effect(one: NamedEffect) -> str:
    names = format_effect(one)
    alike = (
        f'<p class="note">These flights cannot distinguish it from <b>'
        f'{escape(join_words([format_parameter(knob) for knob in one.confusable_with], "or"))}'
        '</b>.</p>'
        if one.confusable_with
        else '<p class="note">No other effect of the library fits these flights as well.</p>'
    )
    return (
        f'<div class="effect"><h3>{escape(names[:1].upper() + names[1:])}</h3>'
        f'<p class="what">{escape(explain_effect(one.name))}</p>'
        f'{"".join(map(_render_parameter, one.parameters))}{_render_assumed_values(one)}'
        f'<p class="note">Evidence for this effect: <b>{format_number(one.log_evidence)} '
        f'nats</b>, {format_odds(one.log_evidence)} compared with the file without '
        f'it.</p>{alike}</div>'
    )


def _render_assumed_values(one: NamedEffect) -> str:
    """Return the assumed numbers that the values of an effect depend on."""
    assumption = format_assumed(one).strip()
    return f'<p class="note">Its values are valid {escape(assumption)}.</p>' if assumption else ''


def _render_parameter(one: ParameterEstimate) -> str:
    """Return one parameter with its interval."""
    value, low, high = format_with_interval(one.value, one.ci95)
    before = one.before if one.in_file else math.nan
    return (
        f'<dl class="learned"><dt>{escape(one.name.replace("_", " "))}</dt>'
        f'<dd><b>{value}</b> {escape(append_unit("", one.unit).strip())} '
        f'<small>95 %: {low} to {high}; {format_file_value(one)}</small></dd></dl>'
        f'{strips.render_interval(before, one.value, one.ci95)}'
    )


def render_search_rounds(finding: StudyResult) -> str:
    """Return all candidates of the search, by round."""
    rungs = [rung for step in finding.ladder for rung in step]
    if not rungs:
        return '<p class="absent">No candidate was promising enough for a full fit.</p>'
    # Leave room to the right of the threshold line, even if no candidate reaches it.
    most = max(GAIN * 1.6, *(rung.total for rung in rungs))
    status = draw_conclusion(finding).effect_status
    out = []
    for k, step in enumerate(finding.ladder, 1):
        named = next((rung for rung in step if rung.accepted), None)
        words = 'nothing is confirmed'
        if named is not None:
            is_named = is_still_named(finding, named.knob)
            words = (
                f'{format_parameter(named.knob)} is {status}'
                f'{"" if is_named else ", but dropped at the end"}'
            )
        out.append(f'<h3>Round {k}: {escape(words)}</h3>')
        heads = ('candidate', 'evidence', 'training [nats]', 'confirming [nats]',
                 'confirming, with the value from training [nats]',
                 'difference of the two values [sigma]', 'decision')  # fmt: skip
        if not step:
            out.append('<p class="note">No candidate was promising enough for a full fit.</p>')
            continue
        rows = [
            _format_candidate_cells(
                rung, most, named is not None, status if is_still_named(finding, rung.knob) else ''
            )
            for rung in step
        ]
        out.append(render_table(heads, rows, 'plain ladder', f'Candidates of round {k}'))
    return ''.join(out)


def _format_candidate_cells(rung: SearchCandidate, most: float, beaten: bool, status: str) -> Row:
    name = escape(format_parameter(rung.knob))
    return (
        f'<b>{name}</b>' if rung.accepted and status else name,
        strips.render_stacked_bar(rung.train, max(rung.confirm, rung.carried), GAIN, most),
        *(format_number(part) for part in (rung.train, rung.confirm, rung.carried)),
        format_number(rung.apart, 2),
        explain_decision(rung, beaten, status),
    )


def render_discrepancies(finding: StudyResult) -> str:
    """Return where the model disagrees most, the largest first."""
    if not finding.where:
        return '<p class="absent">The error exceeds the noise nowhere.</p>'
    most = max(place.ratio_to_noise for place in finding.where)
    rows = [_format_discrepancy(place, most) for place in finding.where]
    heads = ('when', 'error / noise', '', 'channel', 'flight', 'from', 'to')
    first, rest = (
        render_table(heads, part, 'plain places', 'Largest errors of the vehicle file')
        if part
        else ''
        for part in (rows[:MOST], rows[MOST:])
    )
    more = f'<details><summary>{len(rows) - MOST} more</summary>{rest}</details>' if rest else ''
    return first + more


def _format_discrepancy(place: Discrepancy, most: float) -> Row:
    """Return the cells of one discrepancy."""
    return (
        escape(place.condition),
        format_number(place.ratio_to_noise),
        strips.render_bar(place.ratio_to_noise, most),
        escape(NAMES.get(place.channel, place.channel)),
        escape(place.flight),
        f'{format_number(place.from_s)} s',
        f'{format_number(place.to_s)} s',
    )


def render_remainders(finding: StudyResult) -> str:
    """Return the unexplained forces, the largest first."""
    if not finding.remains:
        return ''
    most = max(one.floors for one in finding.remains)
    rows = [_format_remainder(one, most) for one in finding.remains]
    heads = (
        'axis',
        'size / noise floor',
        '',
        'size',
        'description',
        'explained in the other flights',
    )
    return render_table(
        heads, rows, 'plain remains', 'Forces and moments that no effect of the library explains'
    )


def _format_remainder(one: Remainder, most: float) -> Row:
    """Return the cells of one axis."""
    words = format_remainder(one)
    return (
        one.axis,
        format_number(one.floors),
        strips.render_bar(one.floors, most),
        f'{format_number(one.size)} {remainder_unit(one)}',
        escape(words),
        f'{format_percent(one.carried)} %',
    )


def render_unexplained(finding: StudyResult) -> str:
    """Return the unexplained forces, oscillations and draught in sentences."""
    sentences = [*finding.unexplained, *([finding.draught.sentence] if finding.draught else [])]
    if not sentences:
        return ''
    rows = ''.join(
        f'<li>{escape(sentence[:1].upper() + sentence[1:])}.</li>' for sentence in sentences
    )
    return f'<ul class="words">{rows}</ul>'


def render_next_steps(finding: StudyResult) -> str:
    """Return the advice on the vehicle file, and the next flight or measurement."""
    advice = f'{format_advice(finding)} {finding.next_flight}'.strip()
    return f'<p class="what">{escape(advice)}</p>'


def render_warnings(finding: StudyResult) -> str:
    """Return the warnings as a list, or a note that there are none."""
    if not finding.warnings:
        doubt = (
            '.' if draw_conclusion(finding).is_doubtful else ': the data gave no cause for doubt.'
        )
        return f'<p class="note">None{doubt}</p>'
    return (
        f'<ul class="words">{"".join(f"<li>{escape(one)}</li>" for one in finding.warnings)}</ul>'
    )
