# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A cell of one's own behind the simulator's meters, for the monitor to look at.

The circuit is written out here a second time; only the chart of the resting voltage is shared.
"""

import math

from lta_energy.monitoring.meters import MeterReading, PowerSystem
from lta_energy.monitoring.monitor import EnergyEstimate, MonitorSettings, update_estimate
from lta_model.electrical.battery import BatteryModel, open_circuit_voltage
from lta_model.electrical.mppt_charger import ChargerModel
from lta_sim import supply
import numpy as np

from .flight_load import PERIOD, stored

SETTINGS = MonitorSettings()
CELL = BatteryModel(
    capacity=900.0, resistance=0.15, relaxation_resistance=0.094, relaxation_time=33.0
)
ABOARD = PowerSystem(CELL, ChargerModel(tracking=1.0, conversion=1.0, idle=0.0))
START = 1_000_000_000
LOAD = stored()
# How far a cell may be from its file: capacity, both resistances together (cold, age), that of the
# pair besides, and its time constant, relative; its resting voltage from the chart [V].
TOLERANCE = (0.05, 0.3, 0.1, 0.3, 0.0)


class Metered:
    """
    A cell that feeds flights one after the other.

    Parameters
    ----------
    seed : int
        Of its charge, the meters' errors and noise, and where in a flight it begins.
    charge : tuple of float
        Bounds of the charge at the start.
    off : bool
        Whether the cell differs from its file.
    period : float
        Between two readings. [s]

    """

    def __init__(self, seed, charge=(0.3, 1.0), off=False, period=PERIOD):
        self.rng = rng = np.random.default_rng(seed)
        self.charge = rng.uniform(*charge)
        self.relaxation = rng.uniform(-0.03, 0.0)
        share = np.array(TOLERANCE) * rng.uniform(-1.0, 1.0, 5) * off
        capacity, series, pair, time = (1.0 + share[:4]).tolist()
        self.cell = BatteryModel(
            capacity=capacity * CELL.capacity,
            resistance=series * CELL.resistance,
            relaxation_resistance=series * pair * CELL.relaxation_resistance,
            relaxation_time=time * CELL.relaxation_time,
        )
        self.chart = share[4]
        self.settings = supply.PowerMeterSettings()
        self.errors = supply.draw_meter_errors(self.settings, rng)
        self.turn = int(rng.integers(len(LOAD)))
        self.every = round(period / PERIOD)
        self.stamp = START
        self.voltage = self.current = 0.0

    def step(self, watts=None):
        """Feed the load for one period of it; the exact solution of the RC pair."""
        watts = LOAD[self.turn % len(LOAD)] if watts is None else watts
        self.turn += 1
        series, pair = self.cell.resistance, self.cell.relaxation_resistance
        inner = open_circuit_voltage(self.charge) + self.chart + self.relaxation
        # R I^2 + E I + P = 0, the smaller root
        self.current = (-inner + math.sqrt(inner**2 - 4.0 * series * watts)) / (2.0 * series)
        self.voltage = inner + series * self.current
        kept = math.exp(-PERIOD / self.cell.relaxation_time)
        self.relaxation = kept * self.relaxation + (1.0 - kept) * pair * self.current
        self.charge = self.charge + self.current * PERIOD / self.cell.capacity
        self.stamp += round(PERIOD * 1e9)

    def reading(self, watts=None, **other):
        """Return the next turn of the meters."""
        for _ in range(self.every):
            self.step(watts)
        volts, amperes = supply.measure_voltage_and_current(
            self.settings, self.errors, self.voltage, self.current, self.rng
        )
        return MeterReading(
            self.stamp, volts, amperes, **{'panel_voltage': 4.4, 'panel_current': 0.0} | other
        )

    def lasts(self):
        """Return how long it goes on until it is empty [s]."""
        begun = self.stamp
        while self.charge > 0.0:
            self.step()
            if self.voltage < self.cell.discharge_cutoff:
                break
        return (self.stamp - begun) * 1e-9


def follow(readings, settings=SETTINGS, estimate=None):
    """Return what the monitor knows after some readings."""
    estimate = estimate or EnergyEstimate()
    for reading in readings:
        estimate = update_estimate(settings, ABOARD, estimate, reading)
    return estimate
