# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The cell against PyBaMM's Thevenin circuit, where PyBaMM is installed (requirements-pybamm.txt).

`python test/unit/energy/test_battery_pybamm.py` prints how far apart they are.
"""

import sys

from lta_model.electrical import battery
import numpy as np
import pytest

CELL = battery.BatteryModel(
    capacity=900.0, resistance=0.15, relaxation_resistance=0.094, relaxation_time=33.0
)
START, STEP = 0.8, 0.1
# Watts into the cell, half a minute each: standing, climbing, cruising, resting, charging.
POWERS = np.repeat([-0.12, -3.4, -1.5, 0.0, 0.9], 300)


def ours():
    """Return the mean voltage and the current of each step."""
    charge, relaxation, steps = START, 0.0, []
    for power in POWERS.tolist():
        charge, relaxation, *step = battery.advance_cell(CELL, charge, relaxation, power, STEP)
        steps.append(step)
    return np.array(steps).T


def theirs(pybamm, currents):
    """Return the voltage in the middle of each step by PyBaMM, whose currents discharge."""
    model = pybamm.equivalent_circuit.Thevenin()
    values = model.default_parameter_values
    ladder = np.linspace(0.0, 1.0, len(battery.OPEN_CIRCUIT))
    times = np.arange(len(POWERS)) * STEP
    # Each current holds until the next: a step is as steep as the solver is asked to see it.
    edges = np.ravel(np.column_stack([times, times + STEP - 1e-6]))
    held = -np.repeat(currents, 2)
    values.update(
        {
            'Cell capacity [A.h]': CELL.capacity / 3600.0,
            'Nominal cell capacity [A.h]': CELL.capacity / 3600.0,
            'Initial SoC': START,
            'Open-circuit voltage [V]': lambda soc: pybamm.Interpolant(
                ladder, np.array(battery.OPEN_CIRCUIT), soc
            ),
            'R0 [Ohm]': CELL.resistance,
            'R1 [Ohm]': CELL.relaxation_resistance,
            'C1 [F]': CELL.relaxation_time / CELL.relaxation_resistance,
            'Element-1 initial overpotential [V]': 0.0,
            'Entropic change [V/K]': 0.0,
            'Current function [A]': pybamm.Interpolant(edges, held, pybamm.t),
            'Lower voltage cut-off [V]': 2.5,
            'Upper voltage cut-off [V]': 4.5,
        },
        check_already_exists=False,
    )
    solver = pybamm.CasadiSolver(mode='safe', rtol=1e-9, atol=1e-9, dt_max=STEP)
    simulation = pybamm.Simulation(model, parameter_values=values, solver=solver)
    found = simulation.solve(np.array([0.0, *(times + 0.5 * STEP)]))
    return found['Voltage [V]'].entries[1:]


def test_pybamm_finds_the_same_voltage_to_a_tenth_of_a_millivolt():
    pybamm = pytest.importorskip('pybamm')
    volts, currents = ours()
    assert np.max(np.abs(volts - theirs(pybamm, currents))) < 1e-4


if __name__ == '__main__':
    import pybamm

    volts, currents = ours()
    apart = np.abs(volts - theirs(pybamm, currents))
    sys.stdout.write(
        f'{len(apart)} steps of {STEP} s, PyBaMM {pybamm.__version__}: '
        f'largest difference {1e6 * apart.max():.1f} uV, mean {1e6 * apart.mean():.1f} uV\n'
    )
