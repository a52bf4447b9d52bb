# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the noise of a photodiode comes to, for who compares with it."""

from lta_model.sensors.photodiode import noise_variances
import numpy as np


def noise_volts(array, volts):
    """Return the standard deviation at an output that light brings to some volts [V]."""
    amplifier, shot = noise_variances(array)
    return np.sqrt(amplifier + shot * np.asarray(volts))
