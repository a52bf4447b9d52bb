"""Measure discovery: the search for missing elements, by length of two flights, on one core."""

from functools import cache, partial
from pathlib import Path
import sys
import time

from bench import Figure

sys.path.append(str(Path(__file__).resolve().parents[1] / 'unit'))

from discovery.hidden_flight import flown, nominal
from lta_discovery.flights.measured_flight import MeasuredFlight, resample_flight
from lta_discovery.posterior.missing_elements import MissingElementSearch
from lta_model.vehicle import load_vehicle

LENGTHS = (30, 60, 120)  # s


@cache
def flights(length: int) -> list[MeasuredFlight]:
    """Return two flights in which nothing is hidden."""
    return [resample_flight(flown({}, seed, length)) for seed in (1, 2)]


def search(length: int) -> float:
    """Return the processor time of a search. [s]"""
    both = flights(length)
    begin = time.process_time()
    MissingElementSearch(load_vehicle('gtmab'), both, nominal()[1]).run()
    return time.process_time() - begin


def figures() -> list[Figure]:
    """Return what is measured here."""
    return [
        Figure(f'discover.search_{length}', 's', partial(search, length), rounds=1, choose=min)
        for length in LENGTHS
    ]
