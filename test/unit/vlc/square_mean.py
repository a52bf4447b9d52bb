# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The exact mean of a square wave over intervals, for samplers that average."""

import numpy as np


def mean_on(wave, times, interval):
    """Return which part of each interval [ns], at least one, a wave is on."""
    start = wave.phase_in_cycles(times)
    length = wave.frequency * interval * 1e-9
    return (_time_on(wave, start + length) - _time_on(wave, start)) / length


def _time_on(wave, position):
    """Return for how many cycles the wave was on between cycle zero and a position."""
    whole = np.floor(position)
    return whole * wave.duty + np.minimum(position - whole, wave.duty)
