"""
State the calibrated thrust of rotors by duty: for positive ones, and for negative ones.

The model applies the reversed column of a rotor where its thrust is negative. That of a rotor
which the vehicle file has the wrong way round is negative for positive duties.
"""

from collections.abc import Sequence
from dataclasses import replace
import math

from lta_discovery.calibration.result import CalibratedValue, WIDE
from lta_discovery.model.parameters import FreeParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def split_by_duty(thrust: float, reverse: float) -> tuple[float, float]:
    """
    Return the thrust for positive duties, and the share of it for negative ones.

    `thrust`: as a share of that of the file, negative if the rotor is the other way round.
    `reverse`: share of it while it is negative.
    """
    return (thrust * reverse, 1.0 / reverse) if thrust < 0.0 < reverse else (thrust, reverse)


def state_by_duty(
    values: Sequence[CalibratedValue],
    knobs: Sequence[FreeParameter],
    shared: Array,
    covariance: Array,
) -> list[CalibratedValue]:
    """Return the values with those of rotors that the file has the wrong way round by duty."""
    index = {knob.name: k for k, knob in enumerate(knobs)}
    out = {one.name: one for one in values}
    for name in [name for name in index if name.endswith('.reverse')]:
        push = f'{name.removesuffix(".reverse")}.thrust'
        pair = [index[push], index[name]]
        thrust, reverse = 1.0 + shared[pair]
        if not thrust < 0.0 < reverse:
            continue
        # Derivatives of `split_by_duty`
        slopes = np.array([[reverse, thrust], [0.0, -(reverse**-2.0)]])
        spread = slopes @ covariance[np.ix_(pair, pair)] @ slopes.T
        for one, value, variance in zip(
            (push, name), split_by_duty(thrust, reverse), np.diag(spread), strict=True
        ):
            wide = WIDE * math.sqrt(max(float(variance), 0.0))
            ends = (float(value) - wide, float(value) + wide)
            out[one] = replace(out[one], value=float(value), ci95=ends)
    return list(out.values())
