# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The light of a lamp that is switched on and off, without any filter."""


def sample_wave(wave, times):
    """Return whether a lamp is on at some times [ns], as 1.0 or 0.0."""
    return (wave.phase_in_cycles(times) < wave.duty).astype(float)
