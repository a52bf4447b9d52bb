"""Measure the closed loop, and the light's way to an estimate."""

from collections.abc import Callable
from functools import cache, partial
from importlib.metadata import version
import time

from lta_config.topics import load_topic_table
from lta_control.gains_file import load_gains
from lta_control.strategies import find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.world import World
from lta_vlc.diodes import build_even_ring
from lta_vlc.direction import DirectionFinder
from lta_vlc.lamp import estimate_lamp_position, LampPrior
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import DemodulationSettings
import numpy as np
from scipy import fft

from campaigns.bench import Figure

SAMPLE_RATE = 10_000.0  # of each diode, as in config/topics.yaml [1/s]
SAMPLES = 1000  # of a light block
BLOCKS = 50
BEACONS = (150.0, 250.0)  # [Hz]
WINDOW = 2  # bins beside a beacon


def fly_to_lamp() -> float:
    """Return simulated seconds a second of a whole flight, by processor time."""
    scenario, table = load_scenario('lamp_room'), load_topic_table()
    vehicle = load_vehicle('gtmab', scenario.air.density)
    policy = FlightStack(find_navigation_strategy('bag'), load_gains('gtmab'))
    loop = ClosedLoop(World(vehicle, scenario, table, 1), table, policy)
    begin, steps = time.process_time(), 1
    while loop.step() is FlightOutcome.FLYING:
        steps += 1
    if loop.world.outcome is not FlightOutcome.REACHED:
        raise AssertionError(f'the flight ended with {loop.world.outcome}; it must reach the lamp')
    return steps * table.control_ns * 1e-9 / (time.process_time() - begin)


def list_loop() -> list[Figure]:
    """Return the figure of the closed loop in one process."""
    about = (
        'the closed loop in one process on one core: sensors, 8 x 10 kS/s light blocks with '
        'reflections, FFT, fit, estimator, control, energy'
    )
    return [Figure('loop.realtime', 's/s', fly_to_lamp, about)]


@cache
def build_blocks(diodes: int, beacons: tuple[float, ...]) -> np.ndarray:
    """Return blocks of ADC counts in which half the ring sees the beacons; shape (b, n, d)."""
    generator = np.random.default_rng(1)
    time_axis = np.arange(BLOCKS * SAMPLES) / SAMPLE_RATE
    beacon = sum(np.sin(2.0 * np.pi * frequency * time_axis) for frequency in beacons)
    facing = np.maximum(np.cos(2.0 * np.pi * np.arange(diodes) / diodes), 0.0)
    counts = 800.0 + 200.0 * np.outer(beacon, facing)
    counts += generator.normal(0.0, 5.0, counts.shape)
    return np.rint(counts).astype(np.uint16).reshape(BLOCKS, SAMPLES, diodes)


def measure_blocks(blocks: np.ndarray, work: Callable[[np.ndarray], object]) -> float:
    """Return the pace of some work on each block, on one core. [s/s]"""
    begin = time.process_time()
    for block in blocks:
        work(block)
    return BLOCKS * SAMPLES / SAMPLE_RATE / (time.process_time() - begin)


def estimate_lamps(diodes: int) -> float:
    """Return the pace from block to lamp estimate. [s/s]"""
    finder, prior = DirectionFinder(build_even_ring(diodes, 0.07)), LampPrior()
    settings = DemodulationSettings()
    receiver = BeaconReceiver(settings, SAMPLE_RATE, SAMPLES)

    def work(block: np.ndarray) -> object:
        peaks = receiver.demodulate_next_block(block).peaks[0]
        direction = finder.find(peaks, settings.threshold, prior)
        if direction is None:
            raise AssertionError('the beacon is in every block')
        return estimate_lamp_position(direction, prior)

    return measure_blocks(build_blocks(diodes, BEACONS[:1]), work)


def demodulate() -> float:
    """Return the pace of demodulation alone, of two beacons. [s/s]"""
    both = DemodulationSettings(frequency=BEACONS[0], others=BEACONS[1:], window=WINDOW)
    receiver = BeaconReceiver(both, SAMPLE_RATE, SAMPLES)
    return measure_blocks(build_blocks(16, BEACONS), receiver.demodulate_next_block)


def demodulate_plainly() -> float:
    """Return the pace of peaks and SNR of whole bins, as one would write it without ado. [s/s]"""
    quiet = np.ones(SAMPLES // 2 + 1, dtype=bool)
    quiet[0] = False
    for beacon in BEACONS:
        for harmonic in np.arange(beacon, SAMPLE_RATE / 2.0, beacon):
            k = round(harmonic * SAMPLES / SAMPLE_RATE)
            quiet[max(k - WINDOW, 0) : k + WINDOW + 1] = False

    def work(block: np.ndarray) -> object:
        spectrum = np.abs(fft.rfft(block - block.mean(axis=0), axis=0)) * 2.0 / SAMPLES
        noise = spectrum[quiet].mean(axis=0)
        bins = [round(beacon * SAMPLES / SAMPLE_RATE) for beacon in BEACONS]
        peaks = [spectrum[k - WINDOW : k + WINDOW + 1].max(axis=0) for k in bins]
        return [(peak, peak / noise) for peak in peaks]

    return measure_blocks(build_blocks(16, BEACONS), work)


def list_vlc() -> list[Figure]:
    """Return the figures of the light."""
    peer = f'numpy {version("numpy")}, scipy {version("scipy")}'
    return [
        Figure('vlc.realtime', 's/s', partial(estimate_lamps, 8),
               'from ADC block to lamp estimate: 8 diodes, one beacon'),
        Figure('vlc.demodulation', 's/s', demodulate,
               'demodulation of 16 diodes and two beacons, between bins, with tracking and fault '
               'detection; the peer gives whole bins and the SNR only'),
        Figure('vlc.plain', 's/s', demodulate_plainly, of='vlc.demodulation', peer=peer),
    ]  # fmt: skip
