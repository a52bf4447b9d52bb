"""
Measure the light's way from ADC block to lamp estimate, in seconds of light a second.

`vlc.realtime` is all that the demodulator node does but its messages, of one beacon and 8 diodes:
peaks, direction and lamp of blocks of 100 ms at 10 kS/s. `vlc.demodulation` is the demodulation
of 16 diodes and two beacons alone, tracked and with all faults looked for, beside a plain pipeline
of numpy and scipy that gives whole bins and the SNR, and no more.
"""

from collections.abc import Callable
from functools import partial
from importlib.metadata import version
import time

from bench import Figure
from lta_vlc.diodes import build_even_ring
from lta_vlc.direction import DirectionFinder
from lta_vlc.lamp import estimate_lamp_position, LampPrior
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import DemodulationSettings
import numpy as np
from scipy import fft

SAMPLE_RATE = 10_000.0  # of each diode, as in config/topics.yaml [1/s]
SAMPLES = 1000
BLOCKS = 50
BEACONS = (150.0, 250.0)
WINDOW = 2


def blocks(diodes: int, beacons: tuple[float, ...]) -> np.ndarray:
    """Return blocks of ADC counts in which half the ring sees the beacons; shape (b, n, d)."""
    generator = np.random.default_rng(1)
    time_axis = np.arange(BLOCKS * SAMPLES) / SAMPLE_RATE
    beacon = sum(np.sin(2.0 * np.pi * frequency * time_axis) for frequency in beacons)
    facing = np.maximum(np.cos(2.0 * np.pi * np.arange(diodes) / diodes), 0.0)
    counts = 800.0 + 200.0 * np.outer(beacon, facing)
    counts += generator.normal(0.0, 5.0, counts.shape)
    return np.rint(counts).astype(np.uint16).reshape(BLOCKS, SAMPLES, diodes)


def pace(taken: np.ndarray, work: Callable[[np.ndarray], object]) -> Callable[[], float]:
    """Return how to measure the pace of some work on each block, on one core. [s/s]"""

    def measure() -> float:
        begin = time.process_time()
        for block in taken:
            work(block)
        return BLOCKS * SAMPLES / SAMPLE_RATE / (time.process_time() - begin)

    return measure


def seen(diodes: int) -> Callable[[np.ndarray], object]:
    """Return what makes a lamp estimate of a block."""
    finder, prior = DirectionFinder(build_even_ring(diodes, 0.07)), LampPrior()
    settings = DemodulationSettings()
    ears = BeaconReceiver(settings, SAMPLE_RATE, SAMPLES)

    def work(block: np.ndarray) -> object:
        towards = finder.find(
            ears.demodulate_next_block(block).peaks[0], settings.threshold, prior
        )
        if towards is None:
            raise AssertionError('the beacon is in every block')
        return estimate_lamp_position(towards, prior)

    return work


def quiet_mask() -> np.ndarray:
    """Return which bins hold no harmonic of a beacon."""
    quiet = np.ones(SAMPLES // 2 + 1, dtype=bool)
    quiet[0] = False
    for beacon in BEACONS:
        for harmonic in np.arange(beacon, SAMPLE_RATE / 2.0, beacon):
            k = round(harmonic * SAMPLES / SAMPLE_RATE)
            quiet[max(k - WINDOW, 0) : k + WINDOW + 1] = False
    return quiet


def plain(quiet: np.ndarray, block: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return peaks and SNR of whole bins, as one would write it without ado."""
    spectrum = np.abs(fft.rfft(block - block.mean(axis=0), axis=0)) * 2.0 / SAMPLES
    noise = spectrum[quiet].mean(axis=0)
    found = []
    for beacon in BEACONS:
        k = round(beacon * SAMPLES / SAMPLE_RATE)
        peak = spectrum[k - WINDOW : k + WINDOW + 1].max(axis=0)
        found.append((peak, peak / noise))
    return found


def figures() -> list[Figure]:
    """Return what is measured here."""
    both = DemodulationSettings(frequency=BEACONS[0], others=BEACONS[1:], window=WINDOW)
    ears = BeaconReceiver(both, SAMPLE_RATE, SAMPLES)
    taken = blocks(16, BEACONS)
    whole_bins = pace(taken, partial(plain, quiet_mask()))
    peer = f'numpy {version("numpy")}, scipy {version("scipy")}'
    return [
        Figure('vlc.realtime', 's/s', pace(blocks(8, BEACONS[:1]), seen(8)), rounds=20),
        Figure('vlc.realtime_16', 's/s', pace(blocks(16, BEACONS[:1]), seen(16)), rounds=20),
        Figure('vlc.demodulation', 's/s', pace(taken, ears.demodulate_next_block), rounds=20),
        Figure('vlc.plain', 's/s', whole_bins, rounds=20, of='vlc.demodulation', peer=peer),
    ]
