"""Render the evidence of effects identified by forecasts: gain of each, and left-out regimes."""

from collections.abc import Sequence
from html import escape
import math

from lta_discovery.finding import LeftOutKind, StudyResult, TransferEvidence
from lta_discovery.page import strips
from lta_discovery.page.formatting import (
    format_number,
    format_percent,
    join_words,
)
from lta_discovery.page.tables import render_table


def render_transfer(finding: StudyResult) -> str:
    """Return the forecast evidence; '' where only sensor readings were evaluated."""
    evidence = finding.carried
    if evidence is None:
        return ''
    heading, parts = (
        ('Effects identified by forecasts', [_render_names(evidence), _render_regimes(evidence)])
        if evidence.names
        else (
            'Forecasts with everything refitted',
            [_render_refit(finding), _render_regimes(evidence)],
        )
    )
    if evidence.names:
        parts += [_render_kinds(evidence.kinds), _render_refit(finding)]
    return f'<h3>{heading}</h3>{"".join(parts)}<h3>Search by sensor readings</h3>'


def _render_names(evidence: TransferEvidence) -> str:
    """Return what each effect removes of the error, and which effects are not named."""
    most = max(one.share for one in evidence.names)
    names = [
        (
            escape(one.name),
            strips.render_bar(one.share, most),
            f'{format_number(100.0 * one.share, 2)} %',
        )
        for one in evidence.names
    ]
    lost = (
        f'<p class="note">Interpolation only, so not named: <b>'
        f'{escape(join_words(evidence.interpolates))}</b>.</p>'
        if evidence.interpolates
        else ''
    )
    lost += ''.join(f'<p class="note">{escape(one)}.</p>' for one in evidence.rejected)
    return (
        '<p class="note">The model error is so large, or the poses are so smooth, that the '
        'readings do not decide; forecasts of five seconds do. An effect is named if it improves '
        'forecasts in regimes that were left out of its fit, and from training to confirming '
        'flights and back.</p>'
        + render_table(
            ('effect', '', 'removed share of the squared error'),
            names,
            'plain',
            'Error removed by each effect',
        )
        + lost
    )


def _render_regimes(evidence: TransferEvidence) -> str:
    """Return the errors in flight regimes that were left out of the fit."""
    regimes = [
        (escape(one.name), str(one.flights), format_number(one.ratio, 2))
        for one in evidence.regimes
    ]
    worst = format_percent(max(one.ratio for one in evidence.regimes) - 1.0)
    return (
        '<p class="note">Each regime is predicted with a fit to the others. In the worst regime '
        f'the error changes by {worst} % compared with the vehicle file.</p>'
        + render_table(
            ('left-out regime', 'flights', 'error / that of the file'),
            regimes,
            'plain',
            'Regimes left out',
        )
    )


def _render_refit(finding: StudyResult) -> str:
    """Return what the refitted numbers are worth; '' where nothing was refitted."""
    evidence = finding.carried
    if evidence is None or not any(math.isfinite(gap.refitted) for gap in finding.gaps):
        return ''
    named = evidence.names or finding.effects
    what = '' if named else 'Forecasts identify no effect that holds in every regime. '
    return (
        f'<p class="note">{what}The column "refitted" above has the errors with all '
        f'{evidence.numbers} candidate parameters fitted to forecasts. None of them is a '
        'measurement: they compensate each other. They are in refitted.yaml.</p>'
    )


def _render_kinds(kinds: Sequence[LeftOutKind]) -> str:
    """Return the errors in flight of another kind; '' if all flights are of one kind."""
    if not kinds:
        return ''
    rows = [
        (escape(one.name), *(format_number(part, 2) for part in (one.position, one.attitude)))
        for one in kinds
    ]
    return (
        '<p class="note">The pieces of another kind are predicted with a fit to all others. An '
        'effect that makes the position or the attitude of any of them worse is rejected.</p>'
        + render_table(
            ('pieces left out', 'position: error / that of the file', 'attitude'),
            rows,
            'plain',
            'Flight of another kind',
        )
    )
