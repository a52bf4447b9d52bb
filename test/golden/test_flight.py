# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A short flight in one process against stored numbers: what the drone does changes only on purpose.

`python test/golden/test_flight.py --write` stores the flight anew; look at what changed first.

The tolerance is 1e-6, relative or in metres and radians. On one machine with one set of versions
the flight repeats to the bit. Elsewhere libm, numpy's vector units and numba differ by about 1e-16
an operation, which the flight amplifies over 12 s to some 1e-12 (below); 1e-6 leaves room for that
and still tells any change of a gain, a sign or an order, which moves the drone by millimetres.
"""

from pathlib import Path
import sys

from lta_config.topics import load_topic_table
from lta_control.laws import load_gains
from lta_control.strategies import find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_model.scenario import load_scenario
from lta_model.state import RIGID
from lta_model.vehicle import load_vehicle
from lta_sim.simulated_vehicle import SIM_LAYOUT
from lta_sim.world import World
import numpy as np

STORED = Path(__file__).with_name('flight.csv')
SEED = 2
LAG = SIM_LAYOUT.remembers['motor_lag']
STEPS, EVERY = 1200, 50  # 12 s, every 0.5 s
COLUMNS = ['t', 'x', 'y', 'z', 'qx', 'qy', 'qz', 'qw', 'vx', 'vy', 'vz', 'wx', 'wy', 'wz']
COLUMNS += ['u1', 'u2', 'u3', 'u4']
TOLERANCE = 1e-6


def flown(gains=None, nudge=0.0):
    """Return the true state and the reached duties of the flight, one row every 0.5 s."""
    scenario = load_scenario('lamp_room')
    vehicle = load_vehicle('gtmab', scenario.air.density)
    table = load_topic_table()
    world = World(vehicle, scenario, table, SEED)
    world.state[2] += nudge
    loop = ClosedLoop(
        world,
        table,
        FlightStack(find_navigation_strategy('bag'), gains=gains or load_gains('gtmab')),
    )
    rows = []
    for step in range(1, STEPS + 1):
        loop.step()
        if step % EVERY == 0:
            reached = world.state[LAG : LAG + len(vehicle.rotor_names)]
            rows.append([world.elapsed, *world.state[:RIGID], *reached])
    return np.array(rows)


def stored():
    return np.loadtxt(STORED, delimiter=',', skiprows=1)


def same(a, b):
    return np.allclose(a, b, rtol=TOLERANCE, atol=TOLERANCE)


def test_the_flight_is_the_stored_one():
    np.testing.assert_allclose(flown(), stored(), rtol=TOLERANCE, atol=TOLERANCE)


def test_the_last_bits_of_a_machine_stay_within_the_tolerance():
    """Thousands of times a rounding error at the start, and the flight is still the same."""
    assert same(flown(nudge=1e-12), stored())


def test_a_change_of_a_gain_by_a_thousandth_does_not():
    gains = load_gains('gtmab')
    assert not same(
        flown(gains.model_copy(update={'heading_kp': 1.001 * gains.heading_kp})), stored()
    )


if __name__ == '__main__':
    if sys.argv[1:] != ['--write']:
        sys.exit('Give --write to store the flight anew.')
    np.savetxt(STORED, flown(), '%.12g', ',', header=','.join(COLUMNS), comments='')
