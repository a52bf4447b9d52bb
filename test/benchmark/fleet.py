"""
Measure a batch of closed loops on all cores of the processor.

Every flight is the paper's to the lamp, with a seed of its own: kernel, sensors, estimator,
control, allocation, mission and cell. `fleet.closed` is how many seconds of flight are flown in
one; `fleet.open` is the same at constant duties; `fleet.build` is the time to make one flight of
its files, once for all flights that differ by their seed alone.
"""

import time

from bench import Figure
from lta_config.topics import load_topic_table
from lta_flight.batch.batch_flight import BatchFlight, build_flight
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.batch.fly import Device, fly_many
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
import numpy as np

FLIGHTS = 200
HOVER = (0.13, 0.13, 0.0, 0.0)  # of GT-MAB's vertical pair, about


def flight(duties: tuple[float, ...] = ()) -> BatchFlight:
    """Return the paper's flight."""
    return build_flight(
        *build_vehicle_scenario_stack(load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')),
        load_topic_table(),
        duties,
    )


def realtime(device: Device, flights: int, duties: tuple[float, ...] = ()) -> float:
    """Return seconds of flight flown in a second, of a whole call."""
    made, which = flight(duties), np.zeros(flights, dtype=np.intp)
    begin = time.perf_counter()
    told = fly_many([made], range(flights), device, closed=not duties, which=which)
    spent = time.perf_counter() - begin
    return float(told[:, FIGURES.index('end')].sum()) / spent


def build() -> float:
    """Return the time of making a flight. [ms]"""
    begin = time.perf_counter()
    flight()
    return 1e3 * (time.perf_counter() - begin)


def figures() -> list[Figure]:
    """Return what is measured here."""
    return [
        Figure('fleet.closed', 'vehicle s/s', lambda: realtime('cpu-batch', FLIGHTS), 4),
        Figure('fleet.open', 'vehicle s/s', lambda: realtime('cpu-batch', FLIGHTS, HOVER), 4),
        Figure('fleet.build', 'ms', build, choose=min),
    ]
