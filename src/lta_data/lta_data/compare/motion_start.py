"""Find when a flight starts to move, to align separate runs of one plan."""

from collections.abc import Sequence
import math
from typing import Final, NamedTuple

from lta_data.compare.coarse_lag import SharedQuantity, unwrap_finite
from lta_data.compare.divergence import white_noise_deviation
from lta_data.compare.sampling import median_period, SampledSignal
import numpy as np

QUIET: Final = 0.3  # s of rest needed before a start
CLEAR: Final = 8.0  # least deviation from rest, in noise deviations
PART: Final = 0.02  # least deviation from rest, of the channel's range
FEWEST: Final = 3  # channels of motion needed for a start and its uncertainty
CREEP: Final = 0.5  # of the limit; largest drift of a channel at rest
COMMANDS: Final = ('motors', 'wrench_command', 'setpoint/velocity', 'setpoint/pose')


class StartOffset(NamedTuple):
    """B's start minus A's and its standard deviation [s]; channels used; whether commands."""

    offset: float
    sigma: float
    used: tuple[str, ...]
    by_command: bool


def find_motion_start(line: SampledSignal, angular: bool = False) -> float | None:
    """Return when a channel first leaves its initial level; None if it never rested. [s]"""
    time, values = unwrap_finite(line, angular)
    if len(time) < 8 or np.ptp(values) == 0.0:
        return None
    step = median_period(time)
    # At least four samples, for the median of slow channels
    first = time < time[0] + max(QUIET, 4.0 * step)
    level = float(np.median(values[first]))
    low, high = np.percentile(values, [2.0, 98.0])
    # The range excludes outliers: 2 % on either side.
    limit = max(CLEAR * white_noise_deviation(values), PART * float(high - low))
    away = np.abs(values - level) > limit
    ends = np.searchsorted(time, time + max(QUIET, 4.0 * step), side='right')
    total = np.concatenate([[0], np.cumsum(away)])
    here = np.arange(len(time))
    # Three quarters of the window must be away, so that a single outlier is no start.
    lasting = away & ((total[ends] - total[here]) * 4 >= 3 * (ends - here))
    # A channel that drifts from the beginning was moving already
    creep = abs(float(values[first][-1] - values[first][0]))
    if not lasting.any() or creep > CREEP * limit:
        return None
    return float(time[lasting.argmax()])


def estimate_start_offset(shared: Sequence[SharedQuantity]) -> StartOffset | None:
    """
    Return the offset between the starts of two flights; None without a common start.

    Commands are used if they start, otherwise the motion, if enough channels show it. The offset
    is the median over the channels; its uncertainty comes from their scatter and periods.
    """
    # Commands start sharply; motion follows with a delay of its own.
    for by_command in (True, False):
        instants = {}
        for each in shared:
            topic = each.name.rpartition('/')[0]
            if (topic in COMMANDS) is by_command:
                starts = (
                    find_motion_start(each.a, each.angular),
                    find_motion_start(each.b, each.angular),
                )
                if starts[0] is not None and starts[1] is not None:
                    # Both starts are known to one period of their own recording
                    step = math.hypot(median_period(each.a.time), median_period(each.b.time))
                    instants[each.name] = starts[1] - starts[0], step
        if len(instants) >= (1 if by_command else FEWEST):
            offsets = np.array([offset for offset, _ in instants.values()])
            middle = float(np.median(offsets))
            scatter = 1.4826 * float(np.median(np.abs(offsets - middle))) / math.sqrt(len(offsets))
            # Sampling makes a start uncertain by a uniform distribution of one period.
            step = min(step for _, step in instants.values()) / math.sqrt(12.0)
            return StartOffset(middle, math.hypot(scatter, step), tuple(instants), by_command)
    return None
