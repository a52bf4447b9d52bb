"""
Measure a control step of the electricity: loads, charger, cell and books, and the array's search.

`supply.dark` has the light that it had, as at nine steps of ten; `supply.lit` new light, for which
the array's largest power is searched anew.
"""

from functools import partial
import time

from bench import Figure
from lta_model.scenario import SupplyFaults
from lta_model.vehicle import load_vehicle
from lta_sim.supply import Supply
import numpy as np

STEPS = 20_000
THRUSTS = (0.05, 0.05, 0.02, 0.02, 0.0, 0.0, 0.0, 0.0)


def step(lit: bool) -> float:
    """Return the time of a step. [us]"""
    chance = {name: np.random.default_rng(0) for name in ('battery', 'panel')}
    supply = Supply(load_vehicle('gtmab'), 0.8, chance, SupplyFaults().times)
    supply.feed_loads(THRUSTS, 0.01)  # loads what is compiled
    begin = time.process_time()
    for k in range(STEPS):
        if lit:
            supply.set_irradiance(100.0 + 1e-3 * k)
        supply.feed_loads(THRUSTS, 0.01)
    return 1e6 * (time.process_time() - begin) / STEPS


def figures() -> list[Figure]:
    """Return what is measured here."""
    return [
        Figure(f'supply.{name}', 'us of a control step', partial(step, lit), choose=min)
        for name, lit in (('dark', False), ('lit', True))
    ]
