"""Word the warnings that follow from the forecasts of held-out flights."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.finding import ChannelErrors

WHOLE: Final = ('position', 'attitude')
# Times the error with tolerances alone; above it a named effect counts as useless.
WORSE: Final = 1.1


def find_worse_forecasts(gaps: Sequence[ChannelErrors]) -> list[ChannelErrors]:
    """Return the pose errors that are significantly larger than with the vehicle file."""
    return [gap for gap in _select_pose_errors(gaps) if gap.shrink_ci95[1] < 0.0]


def should_keep_file(gaps: Sequence[ChannelErrors]) -> bool:
    """
    Return whether the vehicle file should be kept because the fit is not an improvement.

    It is kept if the position at the longest horizon is significantly worse, or if any error is
    and none is significantly better. At 1 s the error of the initial velocity dominates that of
    the model, so this horizon alone decides nothing.
    """
    lost = find_worse_forecasts(gaps)
    won = any(gap.shrink_ci95[0] > 0.0 for gap in _select_pose_errors(gaps))
    return any(gap in lost for gap in _select_longest_horizons(gaps, WHOLE[:1])) or bool(
        lost and not won
    )


def find_worse_than_tolerances(gaps: Sequence[ChannelErrors]) -> list[ChannelErrors]:
    """Return the errors at the longest horizon that are larger than with tolerances alone."""
    return [gap for gap in _select_longest_horizons(gaps, WHOLE) if gap.after > WORSE * gap.tuned]


def list_forecast_warnings(gaps: Sequence[ChannelErrors]) -> list[str]:
    """Return warnings about fits or names that worsen forecasts, and about useless models."""
    lost, vain = find_worse_forecasts(gaps), find_worse_than_tolerances(gaps)
    idle = [
        gap
        for gap in _select_pose_errors(gaps)
        if gap.coast < min(gap.before, gap.tuned, gap.after)
        and not gap.refitted <= gap.coast  # NaN where nothing was refitted
    ]
    out = []
    if should_keep_file(gaps):
        out.append(
            f'The fitted model predicts worse than the vehicle file '
            f'({_format_channel_horizons(lost)}).'
        )
    elif lost:
        out.append(
            f'Some predictions of the fitted model are less accurate than those of the vehicle '
            f'file: {_format_channel_horizons(lost)}.'
        )
    if vain and not should_keep_file(gaps):
        out.append(
            f'Forecasts with the effects found are worse than without them, if only the values of '
            'the vehicle file are fitted within their tolerances '
            f'({_format_channel_horizons(vain)}): these may be the right effects, but do not '
            'trust their values; record another flight.'
        )
    if idle:
        out.append(
            f'A forecast with constant velocity and turn rates, which ignores the commands, is '
            f'better than every model ({_format_channel_horizons(idle)}).'
        )
    return out


def _select_longest_horizons(
    gaps: Sequence[ChannelErrors], channels: Sequence[str]
) -> list[ChannelErrors]:
    some = [[gap for gap in gaps if gap.channel == channel] for channel in channels]
    return [max(each, key=lambda gap: gap.horizon_s) for each in some if each]


def _select_pose_errors(gaps: Sequence[ChannelErrors]) -> list[ChannelErrors]:
    """Return the gaps of position and attitude."""
    return [gap for gap in gaps if gap.channel in WHOLE]


def _format_channel_horizons(gaps: Sequence[ChannelErrors]) -> str:
    """Return channels and horizons: 'position after 5 s, attitude after 3, 5 s'."""
    parts = []
    for channel in WHOLE:
        after = [f'{gap.horizon_s:.0f}' for gap in gaps if gap.channel == channel]
        if after:
            parts.append(f'{channel} after {", ".join(after)} s')
    return ', '.join(parts)
