"""
Detect data with less noise than any instrument: undeclared simulation or heavy filtering.

Above a third of the sampling rate an airship hardly moves, so that the spectrum there is the noise
of the instrument. Second differences remove the motion before the spectrum is taken, to avoid
leakage. A noise floor below any instrument's means that there was no noise, or that filtering
removed it and distorted derivatives and lags as well.
"""

from collections import defaultdict

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits, roles
from lta_data.data_quality.finding import CheckVerdict, QualityFinding, Severity
from lta_data.data_quality.recording import CheckContext
from lta_data.data_quality.smoothing import sort_samples
import numpy as np
from numpy.typing import NDArray

KIND = 'filtered'
LEVELS = {
    'position': limits.QUIET_POSITION,
    'attitude': limits.QUIET_ATTITUDE,
    'velocity': limits.QUIET_VELOCITY,
    'turning': limits.QUIET_RATES,
    'rates': limits.QUIET_RATES,
    'force': limits.QUIET_FORCE,
    'pressure': limits.QUIET_PRESSURE,
}
WINDOW = 128  # samples of a spectrum
FROM = 0.35  # lower limit of the noise band, of the sampling rate
SHARE = 0.5  # least share of the axes of a vector that lack noise


def find_missing_noise(evidence: CheckContext) -> CheckVerdict:
    """Find vectors with less noise than any instrument."""
    # A declared simulation may be free of noise.
    if evidence.recording.is_simulated:
        return CheckVerdict()
    groups: defaultdict[tuple[str, str], list[SignalChannel]] = defaultdict(list)
    for channel in evidence.recording.channels.values():
        what = roles.match_noisy_quantity(channel)
        # A quantity that was not logged has no numbers
        if what is not None and np.isfinite(channel.values).any():
            groups[what, roles.vector_name(channel.name)].append(channel)
    findings, unjudged = [], []
    for (what, name), group in groups.items():
        levels = [channel_noise(channel) for channel in group]
        # Zero noise is a constant channel, which another check reports.
        positive = np.array([level for level in levels if level is not None and level > 0.0])
        if len(positive) == 0:
            unjudged.append(
                f"The noise of '{name}' cannot be judged: it has fewer than {2 * WINDOW} values."
            )
            continue
        least = LEVELS[what]
        if np.mean(positive < least) >= SHARE and (positive < least).sum() >= min(2, len(group)):
            findings.append(
                build_smoothness_finding(name, group[0], float(np.median(positive)), least)
            )
    return CheckVerdict(tuple(findings), tuple(unjudged))


def channel_noise(channel: SignalChannel) -> float | None:
    """Return the RMS noise of a channel, in its unit; None if it is too short."""
    _, table = sort_samples(channel.time, channel.values[:, None])
    # A jump from pi to -pi would look like noise
    values = np.unwrap(table[:, 0]) if channel.angular else table[:, 0]
    if len(values) < 2 * WINDOW:
        return None
    return high_frequency_noise(np.asarray(values, dtype=np.float64))


def high_frequency_noise(values: NDArray[np.float64]) -> float:
    """
    Return the RMS of white noise at the level of the highest frequencies, in the unit of values.

    The spectrum is the median over half-overlapping Blackman windows.
    """
    # Second differences suppress the slow motion, which would leak into the noise band
    bent = np.diff(values, 2)
    starts = np.arange(0, len(bent) - WINDOW + 1, WINDOW // 2)
    # Low side lobes, for the same reason
    shape = np.blackman(WINDOW)
    pieces = np.stack([bent[start : start + WINDOW] for start in starts]) * shape
    power = np.abs(np.fft.rfft(pieces, axis=1)) ** 2 / (shape**2).sum()
    share = np.arange(power.shape[1]) / WINDOW
    high = share >= FROM
    # Undo the frequency response of the second difference.
    gain = (2.0 * np.sin(np.pi * share[high])) ** 4
    # The median over windows ignores those with impacts
    return float(np.sqrt(np.mean(np.median(power, axis=0)[high] / gain)))


def build_smoothness_finding(
    name: str, channel: SignalChannel, level: float, least: float
) -> QualityFinding:
    """Return the finding of a vector without noise."""
    unit = channel.unit
    return QualityFinding(
        KIND, name, float(channel.time[0]), float(channel.time[-1]),
        f'The noise above a third of the sampling rate is {level:.1e} {unit}, but even the '
        f'quietest real sensors have {least:.0e} {unit}: the data are heavily filtered, or '
        'simulated but not marked so; do not rely on their derivatives, delays and fast motion.',
        Severity.WARNING, {'noise': level, 'least': least},
    )  # fmt: skip
