# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
State in a covariance that a quantity is unknown.

A covariance with a negative variance is none: RViz and fusion nodes reject or misread it. So our
messages give an unknown quantity a very large variance, as ROS drivers commonly do. Bags written
by earlier versions, imported bags and `sensor_msgs` mark it by -1 in the first element.
"""

import numpy as np
from numpy.typing import NDArray

UNKNOWN_VARIANCE = 1e6  # m2, rad2, m2/s2: a kilometre squared is no knowledge


def has_estimate(first: float) -> bool:
    """Return whether a quantity is known, by the first element of its covariance."""
    # NaN says that the covariance is unknown, not the quantity
    return not (first < 0.0 or first >= UNKNOWN_VARIANCE)


def select_estimates(first: NDArray[np.number]) -> NDArray[np.bool_]:
    """Return the same for an array of first elements."""
    return ~((first < 0.0) | (first >= UNKNOWN_VARIANCE))
