"""
Score the energy monitor: 50 cells of unknown charge that feed flights, ten readings a second.

`.venv/bin/python test/score/energy_monitor.py` in the environment of LTA (two to five minutes).
Three kinds of cell: as their file says, off by the tolerances of `test/unit/energy/metered.py`,
and with a resting voltage up to 5 mV off the chart besides. A row tells the error of the charge
after ten minutes and of the time to empty at half charge, the largest and the rms, how many of the
50 are within 5 % and 10 %, and false alarms.
"""

import argparse
from pathlib import Path
import sys

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'unit'))

from energy import metered
from energy.metered import ABOARD, CELL, follow, Metered, SETTINGS
from lta_energy.estimate import Estimate
from lta_energy.monitor import time_to_empty, update

KINDS = {
    'as its file': (0.0, 0.0, 0.0, 0.0, 0.0),
    'off by tolerances': metered.TOLERANCE,
    'and 5 mV off the chart': (*metered.TOLERANCE[:4], 0.005),
}
TEN_MINUTES = 6000  # readings


def charge_error(seed):
    """Return the error of the charge after ten minutes and by its deviation, and the faults."""
    cell = Metered(seed, off=True)
    estimate = follow(cell.reading() for _ in range(TEN_MINUTES))
    error = estimate.charge - cell.charge
    return error, error / estimate.deviation, len(estimate.watch.faults)


def time_error(seed):
    """Return the relative error of the time to empty at half charge, and by its deviation."""
    cell, estimate = Metered(seed, (0.55, 0.75), off=True), Estimate()
    while cell.charge > 0.5:
        estimate = update(SETTINGS, ABOARD, estimate, cell.reading())
    told, true = time_to_empty(SETTINGS, CELL, estimate), cell.lasts()
    return told.mean / true - 1.0, (told.mean - true) / told.deviation


def row(seeds):
    """Return a line of figures over seeds."""
    charges = np.array([charge_error(seed) for seed in range(seeds)])
    times = np.array([time_error(seed) for seed in range(seeds)])
    said = []
    for errors, limit in ((charges, 0.05), (times, 0.10)):
        size = np.abs(errors[:, 0])
        rms = np.sqrt((errors[:, :2] ** 2).mean(0))
        within = int((size <= limit).sum())
        said.append(
            f'{100 * size.max():.1f} % | {100 * rms[0]:.1f} % | {within} of {seeds} | {rms[1]:.2f}'
        )
    return f'{said[0]} | {said[1]} | {int(charges[:, 2].sum())}'


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1])
    parser.add_argument('--seeds', type=int, default=50)
    seeds = parser.parse_args().seeds
    head = 'largest | rms | within | rms by deviation'
    sys.stdout.write(f'| cell | charge: {head} | time: {head} | false alarms |\n')
    for kind, tolerance in KINDS.items():
        metered.TOLERANCE = tolerance
        sys.stdout.write(f'| {kind} | {row(seeds)} |\n')
        sys.stdout.flush()


if __name__ == '__main__':
    main()
