# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sampled waves to listen to, written without the code under test."""

import math

import numpy as np

RATE, SAMPLES = 10_000.0, 1000
TIME = np.arange(SAMPLES) / RATE


def tone(frequency: float, phase: float = 0.0, amplitude: float = 1.0) -> np.ndarray:
    """Return a cosine, shape (n,)."""
    return amplitude * np.cos(2.0 * math.pi * frequency * TIME + phase)


def square(frequency: float, phase: float = 0.0, amplitude: float = 1.0) -> np.ndarray:
    """Return what of a square wave lies below the Nyquist frequency; its fundamental has 1."""
    orders = np.arange(1, math.ceil(RATE / 2.0 / frequency), 2)
    parts = [
        tone(q * frequency, q * phase + (q // 2) * math.pi, amplitude / q) for q in orders.tolist()
    ]
    return np.sum(parts, axis=0)
