"""
Detect channels that are clipped by their instrument, ADC or a program.

Measured values thin out towards their extremes. At a limit the extreme value is the most frequent
one, and it lasts for several samples.
"""

from collections.abc import Iterator

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits, roles
from lta_data.data_quality.checks.constant_channels import is_constant
from lta_data.data_quality.checks.freezes import ends_with_jump, find_initial_run_end, START
from lta_data.data_quality.finding import CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.recording import CheckContext
from lta_data.data_quality.smoothing import find_coarse_unit, find_runs
import numpy as np

KIND = 'clipped'
NEIGHBOURS = 3  # adjacent values whose counts are compared
ADC = 'photodiodes'
UNKNOWN_TOP = (
    "The range of the photodiodes' ADC is unknown, because the recording has no readable vehicle "
    'file: clipping at its upper end cannot be judged.'
)


def find_clipping(evidence: CheckContext) -> CheckVerdict:
    """Find accumulations at extremes, and ADC blocks at the limits of the ADC."""
    findings: list[QualityFinding] = []
    for channel in evidence.recording.channels.values():
        if roles.match_noisy_quantity(channel):
            findings += find_pileups(channel, evidence.recording.is_simulated)
        elif channel.topic == ADC and channel.field.startswith(('min[', 'max[')):
            findings += find_railed_blocks(channel, evidence)
    lit = any(channel.topic == ADC for channel in evidence.recording.channels.values())
    return CheckVerdict(
        tuple(findings), (UNKNOWN_TOP,) if lit and evidence.adc_full_scale is None else ()
    )


def find_pileups(channel: SignalChannel, simulated: bool) -> Iterator[QualityFinding]:
    """Yield the extremes of one channel at which values accumulate."""
    good = np.isfinite(channel.values)
    if simulated:  # exactly constant until take-off
        good[
            : find_initial_run_end(np.diff(channel.values, prepend=channel.values[:1]) == 0.0)
        ] = False
    values, time = channel.values[good], channel.time[good]
    if len(values) < limits.LEAST_SAMPLES or is_constant(channel) or find_coarse_unit(values):
        return
    levels, counts = np.unique(values, return_counts=True)
    for side, word in ((0, 'lowest'), (-1, 'highest')):
        count = int(counts[side])
        # np.unique sorts, so the next counts belong to the values next to the extreme
        beside = counts[1 : 1 + NEIGHBOURS] if side == 0 else counts[-1 - NEIGHBOURS : -1]
        if count < limits.CLIPPED_SAMPLES or count < limits.CLIPPED_PILE * float(
            np.median(beside)
        ):
            continue
        at = find_runs(values == levels[side])
        alone = len(at) == 1
        # A simulated vehicle on the floor is at its extreme, unclipped.
        rests = simulated and alone and (at[0, 0] <= START or at[0, 1] == len(values))
        # A single run that ends with a jump is a freeze, which another check reports
        stopped = alone and ends_with_jump(values, int(at[0, 1]) - 1)
        if (at[:, 1] - at[:, 0]).max() < limits.CLIPPED_RUN or rests or stopped:
            continue
        yield QualityFinding(
            KIND, channel.name, float(time[at[0, 0]]), float(time[at[-1, 1] - 1]),
            f'{count} of {len(values)} readings have the {word} value, {levels[side]:.6g} '
            f'{channel.unit}, but the adjacent values occur only {np.median(beside):.0f} '
            'times each: the channel is clipped.',
            Severity.SUSPICIOUS, {'limit': float(levels[side]), 'readings': float(count)},
        )  # fmt: skip


def find_railed_blocks(channel: SignalChannel, evidence: CheckContext) -> Iterator[QualityFinding]:
    """Yield the span in which blocks of one diode reach a limit of the ADC."""
    # Counts; the lower limit of a single-ended ADC is zero
    end = evidence.adc_full_scale if channel.field.startswith('max[') else 0.0
    if end is None:
        return
    at = channel.values == end
    if int(at.sum()) >= limits.ADC_BLOCKS:
        times = channel.time[at]
        yield QualityFinding(
            KIND, channel.name, float(times[0]), float(times[-1]),
            f'{int(at.sum())} of {len(at)} sample blocks reach the ADC limit of {end:.0f} counts.',
            Severity.SUSPICIOUS, {'limit': end, 'blocks': float(at.sum())},
        )  # fmt: skip
