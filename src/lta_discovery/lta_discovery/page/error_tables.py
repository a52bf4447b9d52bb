"""Render prediction errors under each model as HTML: pose first, then every channel."""

from collections.abc import Sequence
from html import escape
import math
from typing import Final

from lta_discovery.finding import ChannelErrors, StudyResult
from lta_discovery.forecast.flight_prediction import NAMES
from lta_discovery.page import strips
from lta_discovery.page.formatting import format_percent, format_quantity, join_words
from lta_discovery.page.tables import render_table, Row

HEADS: Final = (
    'before', 'tuned', 'after', 'coast', 'noise', 'reduced by', '95 % interval', 'pieces',
)  # fmt: skip
WHOLE: Final = ('position', 'attitude')
KEY: Final = (
    '<p class="note"><i class="key before"></i>before <i class="key tuned"></i>tuned '
    '<i class="key after"></i>after <i class="key coast"></i>coast '
    '<i class="key noise"></i>noise</p>'
)


def render_pose_errors(finding: StudyResult) -> str:
    """Return the errors of position and attitude under all models, by horizon."""
    if not finding.gaps:
        return (
            '<p class="note">There was no flight to compute prediction errors on.</p>'
            f'{_render_training_errors(finding)}'
        )
    whole = [gap for gap in finding.gaps if gap.channel in WHOLE] or list(finding.gaps)
    tables = _render_error_tables(whole)
    return (
        f'{KEY}{tables}<p class="note">{escape(_format_scope(finding))}</p>'
        f'{_render_training_errors(finding)}'
    )


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
    out = []
    for channel in dict.fromkeys(gap.channel for gap in errors):
        of = [gap for gap in errors if gap.channel == channel]
        low, high = log_scale_limits(of)
        rows = [
            (_format_horizon(gap), _render_strip(gap, low, high), *_format_error_cells(gap))
            for gap in of
        ]
        title = NAMES.get(channel, channel)
        caption = f'Errors of {title}{where}'
        inside = render_table(('horizon', '', *HEADS), rows, 'plain gaps', caption)
        out.append(f'<h3>{escape(title.capitalize())}</h3>{inside}')
    return ''.join(out)


def render_channel_errors(finding: StudyResult) -> str:
    """Return the errors of the single channels; '' where only the pose was measured."""
    single = [gap for gap in finding.gaps if gap.channel not in WHOLE]
    if not single or len(single) == len(finding.gaps):
        return ''
    rows = [
        (
            escape(NAMES.get(gap.channel, gap.channel)),
            _format_horizon(gap),
            *_format_error_cells(gap),
        )
        for gap in single
    ]
    inside = render_table(
        ('channel', 'horizon', *HEADS), rows, 'plain', 'Errors of single channels'
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
    return (
        f'Root mean square errors {whose}. Before: with the vehicle file. Tuned: with its '
        'parameters fitted within their tolerances, without a new effect. After: with the named '
        'effects. Coast: with constant velocity and turn rates, without the commands. Shaded: the '
        'measurement noise, the smallest error that can be seen. The reduction is from before to '
        'after; its interval is a bootstrap over the pieces of flight.'
    )


def log_scale_limits(of: Sequence[ChannelErrors]) -> tuple[float, float]:
    """Return the limits of a logarithmic scale for all errors of a channel."""
    every = [
        part
        for gap in of
        for part in (gap.before, gap.tuned, gap.after, gap.coast, gap.noise_floor)
        if math.isfinite(part) and part > 0.0
    ]
    return min(every, default=1.0) / 1.3, max(every, default=1.0) * 1.1


def _format_horizon(gap: ChannelErrors) -> str:
    return f'{gap.horizon_s:g} s'


def _render_strip(gap: ChannelErrors, low: float, high: float) -> str:
    """Return the errors of all models as points on one scale."""
    four = {'coast': gap.coast, 'before': gap.before, 'tuned': gap.tuned, 'after': gap.after}
    return strips.render_log_points(four, low, high, gap.noise_floor)


def _format_error_cells(gap: ChannelErrors) -> Row:
    """Return the table cells of one channel at one horizon, in the order of HEADS."""
    five = (gap.before, gap.tuned, gap.after, gap.coast, gap.noise_floor)
    a, b = (format_percent(part) for part in gap.shrink_ci95)
    errors = (format_quantity(part, gap.unit) for part in five)
    return (*errors, f'{format_percent(gap.shrink)} %', f'{a} to {b} %', str(gap.pieces))
