"""What the forecasts of held-out flights warn of, in words."""

from collections.abc import Sequence
from typing import Final

from lta_analysis.discovery.finding import Gap

WHOLE: Final = ('position', 'attitude')
WORSE: Final = (
    1.1  # times the error with tolerances alone, above which a name is said to be in vain
)


def keeps(gaps: Sequence[Gap]) -> bool:
    """Tell whether the vehicle file should be kept: what was fitted surely predicts worse."""
    return any(gap.channel in WHOLE and gap.shrink_ci95[1] < 0.0 for gap in gaps)


def cautions(gaps: Sequence[Gap]) -> list[str]:
    """
    Return sentences: where a fit or a name made forecasts worse, and where no model is of use.

    Parameters
    ----------
    gaps : sequence of Gap
        Of flights that nothing was fitted to.

    """
    told = [gap for gap in gaps if gap.channel in WHOLE]
    vain = [gap for gap in told if gap.after > WORSE * gap.tuned]
    worse = [gap for gap in told if gap.shrink_ci95[1] < 0.0]
    idle = [gap for gap in told if gap.coast < min(gap.before, gap.tuned, gap.after)]
    out = []
    if worse:
        out.append(
            f'What was fitted predicts worse than the vehicle file ({_listed(worse)}): it follows '
            'what no effect explains; keep the vehicle file.'
        )
    if vain and not worse:
        out.append(
            f'With what was named, forecasts are worse than with tolerances alone '
            f'({_listed(vain)}): the name may be right, but do not trust its value; fly again.'
        )
    if idle:
        out.append(f'Keeping velocity and rates predicts better than any model ({_listed(idle)}).')
    return out


def _listed(gaps: Sequence[Gap]) -> str:
    """Return channels and horizons: 'position after 5 s, attitude after 3, 5 s'."""
    parts = []
    for channel in WHOLE:
        after = [f'{gap.horizon_s:.0f}' for gap in gaps if gap.channel == channel]
        if after:
            parts.append(f'{channel} after {", ".join(after)} s')
    return ', '.join(parts)
