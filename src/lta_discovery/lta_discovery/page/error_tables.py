"""Render prediction errors under each model as HTML: pose first, then every channel."""

from collections.abc import Mapping, Sequence
from html import escape
import math
from typing import Final

from lta_discovery.conclusion import draw_conclusion
from lta_discovery.finding import ChannelErrors, StudyResult
from lta_discovery.forecast.flight_prediction import NAMES
from lta_discovery.page import strips
from lta_discovery.page.formatting import format_percent, format_quantity, join_words
from lta_discovery.page.tables import render_table, Row

# Models in the order of the columns, with the field that holds their error
MODELS: Final = {
    'before': 'before', 'tuned': 'tuned', 'after': 'after', 'refitted': 'refitted',
    'coast': 'coast', 'noise': 'noise_floor',
}  # fmt: skip
HEADS: Final = ('reduced by', '95 % interval', 'pieces')
WHOLE: Final = ('position', 'attitude')
REFITTED: Final = 'Refitted: with all numbers fitted to forecasts, as in refitted.yaml. '


def render_pose_errors(finding: StudyResult) -> str:
    """Return the errors of position and attitude under all models, by horizon."""
    if not finding.gaps:
        return (
            '<p class="note">There was no flight to compute prediction errors on.</p>'
            f'{_render_training_errors(finding)}'
        )
    whole = [gap for gap in finding.gaps if gap.channel in WHOLE] or list(finding.gaps)
    tables = _render_error_tables(whole)
    key = ' '.join(f'<i class="key {one}"></i>{one}' for one in _list_models(whole))
    return (
        f'<p class="note">{key}</p>{tables}<p class="note">{escape(_format_scope(finding))}</p>'
        f'{_render_training_errors(finding)}'
    )


def _list_models(errors: Sequence[ChannelErrors]) -> dict[str, str]:
    """Return the models with errors: without the refitted one where nothing was refitted."""
    refitted = any(math.isfinite(gap.refitted) for gap in errors)
    return {name: of for name, of in MODELS.items() if refitted or name != 'refitted'}


def _render_training_errors(finding: StudyResult) -> str:
    """Return the errors on the flights of the fit, folded; '' if they are unknown."""
    if not finding.training:
        return ''
    return (
        '<details><summary>The same on the flights of the fit</summary>'
        f'{_render_error_tables(finding.training, " on the flights of the fit")}</details>'
    )


def _render_error_tables(errors: Sequence[ChannelErrors], where: str = '') -> str:
    """Return a table of the errors of each channel under all models, by horizon."""
    out, models = [], _list_models(errors)
    for channel in dict.fromkeys(gap.channel for gap in errors):
        of = [gap for gap in errors if gap.channel == channel]
        low, high = log_scale_limits(of)
        rows = [
            (_format_horizon(gap), _render_strip(gap, low, high), *_format_cells(gap, models))
            for gap in of
        ]
        title = NAMES.get(channel, channel)
        caption = f'Errors of {title}{where}'
        inside = render_table(('horizon', '', *models, *HEADS), rows, 'plain gaps', caption)
        out.append(f'<h3>{escape(title.capitalize())}</h3>{inside}')
    return ''.join(out)


def render_channel_errors(finding: StudyResult) -> str:
    """Return the errors of the single channels; '' where only the pose was measured."""
    single = [gap for gap in finding.gaps if gap.channel not in WHOLE]
    if not single or len(single) == len(finding.gaps):
        return ''
    models = _list_models(single)
    rows = [
        (
            escape(NAMES.get(gap.channel, gap.channel)),
            _format_horizon(gap),
            *_format_cells(gap, models),
        )
        for gap in single
    ]
    inside = render_table(
        ('channel', 'horizon', *models, *HEADS), rows, 'plain', 'Errors of single channels'
    )
    summary = '<summary>Every channel that was measured, at every horizon</summary>'
    return f'<details>{summary}{inside}</details>'


def _format_scope(finding: StudyResult) -> str:
    """Describe the flights and columns of the errors."""
    whose = (
        f'on {join_words(finding.bags.get("holdout", ()))}, which no fit has used'
        if finding.held_out
        else 'on flights that the search has used as well'
    )
    refitted = REFITTED if 'refitted' in _list_models(finding.gaps) else ''
    status = draw_conclusion(finding).effect_status
    return (
        f'Root mean square errors {whose}. Before: with the vehicle file. Tuned: with its '
        'parameters fitted within their tolerances, without a new effect. After: with the '
        f'{status} effects. {refitted}Coast: with constant velocity and turn rates, '
        'without the commands. Shaded: the measurement noise, the smallest error that can be '
        'seen. The reduction is from before to after; its interval is a bootstrap over the '
        'pieces of flight.'
    )


def log_scale_limits(of: Sequence[ChannelErrors]) -> tuple[float, float]:
    """Return the limits of a logarithmic scale for all errors of a channel."""
    every = [
        part
        for gap in of
        for part in (getattr(gap, field) for field in MODELS.values())
        if math.isfinite(part) and part > 0.0
    ]
    return min(every, default=1.0) / 1.3, max(every, default=1.0) * 1.1


def _format_horizon(gap: ChannelErrors) -> str:
    return f'{gap.horizon_s:g} s'


def _render_strip(gap: ChannelErrors, low: float, high: float) -> str:
    """Return the errors of all models as points on one scale."""
    # The last drawn is on top
    kinds = ('coast', 'before', 'refitted', 'tuned', 'after')
    errors = {kind: getattr(gap, kind) for kind in kinds}
    return strips.render_log_points(errors, low, high, gap.noise_floor)


def _format_cells(gap: ChannelErrors, models: Mapping[str, str]) -> Row:
    """Return the table cells of one channel at one horizon: models, then those of HEADS."""
    a, b = (format_percent(part) for part in gap.shrink_ci95)
    errors = (format_quantity(getattr(gap, field), gap.unit) for field in models.values())
    return (*errors, f'{format_percent(gap.shrink)} %', f'{a} to {b} %', str(gap.pieces))
