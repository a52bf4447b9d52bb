"""
Measure the light's way from ADC block to lamp estimate, in seconds of light a second.

All that the demodulator node does but its messages: spectrum, peaks, direction and lamp of blocks
of 100 ms at 10 kS/s, with the paper's 8 diodes and with 16.
"""

from collections.abc import Callable
import time

from bench import Figure
from lta_vlc.demodulation import demodulate, Demodulation, plan_bins
from lta_vlc.diodes import ring_of
from lta_vlc.direction import DirectionFinder
from lta_vlc.lamp import lamp_estimate, LampPrior
import numpy as np

SAMPLE_RATE = 10_000.0  # of each diode, as in config/topics.yaml [1/s]
SAMPLES = 1000
BLOCKS = 50
SETTINGS = Demodulation()


def blocks(diodes: int) -> np.ndarray:
    """Return blocks of ADC counts in which half the ring sees the beacon; shape (b, n, d)."""
    generator = np.random.default_rng(1)
    time_axis = np.arange(BLOCKS * SAMPLES) / SAMPLE_RATE
    beacon = np.sin(2.0 * np.pi * SETTINGS.frequency * time_axis)
    facing = np.maximum(np.cos(2.0 * np.pi * np.arange(diodes) / diodes), 0.0)
    counts = 800.0 + 200.0 * np.outer(beacon, facing)
    counts += generator.normal(0.0, 5.0, counts.shape)
    return np.rint(counts).astype(np.uint16).reshape(BLOCKS, SAMPLES, diodes)


def pace(diodes: int) -> Callable[[], float]:
    """Return how to measure the pace with that many diodes. [s/s]"""
    taken, finder = blocks(diodes), DirectionFinder(ring_of(diodes, 0.07))
    bins, prior = plan_bins(SETTINGS, SAMPLE_RATE, SAMPLES), LampPrior()

    def measure() -> float:
        begin = time.perf_counter()
        for block in taken:
            towards = finder.find(demodulate(block, bins), SETTINGS.threshold, prior)
            if towards is None:
                raise AssertionError('the beacon is in every block')
            lamp_estimate(towards, prior)
        return BLOCKS * SAMPLES / SAMPLE_RATE / (time.perf_counter() - begin)

    return measure


def figures() -> list[Figure]:
    """Return what is measured here."""
    return [
        Figure('vlc.realtime', 's/s', pace(8), rounds=20),
        Figure('vlc.realtime_16', 's/s', pace(16), rounds=20),
    ]
