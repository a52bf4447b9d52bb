"""
How much force flights leave unexplained: the most probable deviations of the latent wrench.

A large missing effect can hide behind large deviations; so they are looked for from where they are
and from small ones, and the better is taken.
"""

from collections.abc import Callable, Sequence
from typing import Final

from lta_analysis.discovery.fit.evidence import evidence_of, log_prior, Prior
from lta_analysis.discovery.fit.group import Group
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALL: Final = 2.5  # floors; the largest deviations of the second start
SWEEPS: Final = 4
STRIDE: Final = 0.5  # of the logarithm of a deviation
LOWEST, HIGHEST = 0.05, 1e3  # floors


def best(value: Callable[[Array], float], start: Array, floor: Array) -> tuple[Array, float]:
    """
    Return the deviations of greatest value near a start, and the value.

    Newton steps on the logarithms, axis by axis at once, halved until they help.
    """
    low, high = np.log(LOWEST * floor), np.log(HIGHEST * floor)
    at = np.clip(np.log(start), low, high)
    now = value(np.exp(at))
    for _ in range(SWEEPS):
        step = np.zeros(len(at))
        for k in range(len(at)):
            aside = np.zeros(len(at))
            aside[k] = STRIDE
            up, down = value(np.exp(at + aside)), value(np.exp(at - aside))
            slope, bend = (up - down) / (2 * STRIDE), (up - 2 * now + down) / STRIDE**2
            step[k] = np.clip(-slope / bend, -2.0, 2.0) if bend < -1e-3 else 1.5 * np.sign(slope)
        before = now
        for _ in range(4):
            trial = np.clip(at + step, low, high)
            there = value(np.exp(trial))
            if there > now:
                at, now = trial, there
                break
            step *= 0.5
        if now - before < 0.05:
            break
    return np.exp(at), now


def weighed(
    group: Group, prior: Prior, start: Array, floor: Array, caps: Sequence[float] = (SMALL,)
) -> tuple[Array, float]:
    """
    Return the most probable deviations of the latent wrench, and the log evidence with theirs.

    Parameters
    ----------
    group : Group
        The flights.
    prior : Prior
        Of what they share.
    start, floor : ndarray, shape (6,)
        Deviations to begin with, and those that are not worth speaking of.
    caps : sequence of float
        Of further starts. [floors]

    """
    narrow, kept = group.narrowed(prior.free)
    own = Prior(prior.mean[kept], prior.covariance[np.ix_(kept, kept)])

    def value(deviations: Array) -> float:
        try:
            found = evidence_of(narrow.reduced(deviations), narrow.at, own)
        except np.linalg.LinAlgError:
            return -np.inf  # so far off that nothing is left of a column but rounding
        return found + log_prior(deviations, floor)

    starts = [start, *(np.minimum(start, cap * floor) for cap in caps)]
    distinct = [s for k, s in enumerate(starts) if k == 0 or not np.allclose(s, start)]
    return max((best(value, s, floor) for s in distinct), key=lambda found: found[1])
