"""What the forecasts of held-out flights warn of, in words."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.finding import PredictionGap

WHOLE: Final = ('position', 'attitude')
# Times the error with tolerances alone, above which a name is said to be in vain.
WORSE: Final = 1.1


def find_worse_gaps(gaps: Sequence[PredictionGap]) -> list[PredictionGap]:
    """Return where what was fitted surely predicts worse than the vehicle file."""
    return [gap for gap in _select_pose(gaps) if gap.shrink_ci95[1] < 0.0]


def should_keep_file(gaps: Sequence[PredictionGap]) -> bool:
    """
    Tell whether the vehicle file should be kept: what was fitted is no gain.

    It is none where the position is surely worse furthest ahead, or something is surely worse and
    nothing surely better. A second ahead, a pose errs by the velocity that it began with more than
    by any model: that alone decides nothing.
    """
    lost = find_worse_gaps(gaps)
    won = any(gap.shrink_ci95[0] > 0.0 for gap in _select_pose(gaps))
    return any(gap in lost for gap in _select_furthest(gaps, WHOLE[:1])) or bool(lost and not won)


def find_vain_gaps(gaps: Sequence[PredictionGap]) -> list[PredictionGap]:
    """Return where, furthest ahead, the names predict worse than tolerances alone."""
    return [gap for gap in _select_furthest(gaps, WHOLE) if gap.after > WORSE * gap.tuned]


def list_forecast_warnings(gaps: Sequence[PredictionGap]) -> list[str]:
    """
    Return sentences: where a fit or a name made forecasts worse, and where no model is of use.

    Parameters
    ----------
    gaps : sequence of Gap
        Of flights that nothing was fitted to.

    """
    lost, vain = find_worse_gaps(gaps), find_vain_gaps(gaps)
    idle = [gap for gap in _select_pose(gaps) if gap.coast < min(gap.before, gap.tuned, gap.after)]
    out = []
    if should_keep_file(gaps):
        out.append(
            f'What was fitted predicts worse than the vehicle file ({_format_gaps(lost)}): '
            'keep the vehicle file.'
        )
    elif lost:
        out.append(f'Not all forecasts get better: worse are {_format_gaps(lost)}.')
    if vain and not should_keep_file(gaps):
        out.append(
            f'With what was named, forecasts are worse than with tolerances alone '
            f'({_format_gaps(vain)}): the name may be right, but do not trust its value; fly '
            f'again.'
        )
    if idle:
        out.append(
            f'Keeping velocity and rates predicts better than any model ({_format_gaps(idle)}).'
        )
    return out


def _select_furthest(
    gaps: Sequence[PredictionGap], channels: Sequence[str]
) -> list[PredictionGap]:
    """Return the gap of each channel furthest ahead."""
    some = [[gap for gap in gaps if gap.channel == channel] for channel in channels]
    return [max(each, key=lambda gap: gap.horizon_s) for each in some if each]


def _select_pose(gaps: Sequence[PredictionGap]) -> list[PredictionGap]:
    """Return the gaps of the pose as a whole."""
    return [gap for gap in gaps if gap.channel in WHOLE]


def _format_gaps(gaps: Sequence[PredictionGap]) -> str:
    """Return channels and horizons: 'position after 5 s, attitude after 3, 5 s'."""
    parts = []
    for channel in WHOLE:
        after = [f'{gap.horizon_s:.0f}' for gap in gaps if gap.channel == channel]
        if after:
            parts.append(f'{channel} after {", ".join(after)} s')
    return ', '.join(parts)
