"""
Score the energy monitor: 50 cells of unknown charge that feed flights, ten readings a second.

`.venv/bin/python test/score/energy_monitor.py` in the environment of LTA (two to five minutes).
Three kinds of cell: as their file says, off by the tolerances of `test/unit/energy/metered.py`,
and with a resting voltage up to 5 mV off the chart besides. A row tells the error of the charge
after ten minutes and of the time to empty at half charge, the largest and the rms, how many of the
50 are within 5 % and 10 %, and false alarms. `--picture docs/images/energy_monitor.png` draws how
the error of the charge shrinks, instead; it needs a Chromium.
"""

import argparse
from pathlib import Path
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'unit'))

from energy import metered
from energy.metered import ABOARD, CELL, follow, Metered, SETTINGS
from lta_energy.monitoring.monitor import EnergyEstimate, update_estimate
from lta_energy.monitoring.report import report_energy
from lta_report.drawing import build_line_trace, create_figure
from lta_report.page_frame import write_file
from lta_report.palette import RAW, SETPOINT, TRUTH
from lta_report.report import Picture, Report
from lta_report.report_page import render_report
from lta_report.screenshots import write_picture

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
    cell, estimate = Metered(seed, (0.55, 0.75), off=True), EnergyEstimate()
    while cell.charge > 0.5:
        estimate = update_estimate(SETTINGS, ABOARD, estimate, cell.reading())
    told, true = report_energy(SETTINGS, CELL, estimate).empty, cell.lasts()
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


def course(seed):
    """Return error and deviation of the charge after each second of ten minutes. [%]"""
    cell, estimate, told = Metered(seed, off=True), EnergyEstimate(), []
    for turn in range(TEN_MINUTES):
        estimate = update_estimate(SETTINGS, ABOARD, estimate, cell.reading())
        if turn % 10 == 9:
            told.append((estimate.charge - cell.charge, estimate.deviation))
    return 100.0 * np.array(told).T


def draw(seeds, out):
    """Write a picture of the error of each cell, and twice what most of them tell of it."""
    metered.TOLERANCE = KINDS['off by tolerances']
    courses = np.array([course(seed) for seed in range(seeds)])
    minutes = np.arange(1, courses.shape[2] + 1) / 60.0
    figure = create_figure()
    for error in courses[:, 0]:
        figure.add_trace(build_line_trace('a cell', minutes, error, RAW, unit='%', width=0.8))
    told = 2.0 * np.median(courses[:, 1], axis=0)
    for side in (-told, told):
        figure.add_trace(
            build_line_trace('twice its own deviation', minutes, side, TRUTH, unit='%')
        )
    for limit in (-5.0, 5.0):
        goal = np.full(2, limit)
        figure.add_trace(
            build_line_trace('goal', minutes[[0, -1]], goal, SETPOINT, unit='%', dash='4px,3px')
        )
    figure.update_xaxes(title_text='time [min]', range=[0.0, 10.0])
    figure.update_yaxes(title_text='error of the charge [% of a full cell]', range=[-10.0, 10.0])
    caption = (
        f'{seeds} cells of unknown charge, off by tolerances, that feed flights (grey); twice the '
        'deviation that the median cell tells (blue); the goal, 5 % (dashed).'
    )
    name = 'What the monitor knows of the charge'
    picture = Picture('charge', name, caption, figure)
    text = render_report(Report('energy monitor', '', name, '', (), (picture,), {}))
    with tempfile.TemporaryDirectory() as folder:
        write_picture(write_file(text, Path(folder) / 'page.html'), out, 'charge')


def main():
    """Print the table, or draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1])
    parser.add_argument('--seeds', type=int, default=50)
    parser.add_argument('--picture', type=Path, metavar='FILE.png')
    order = parser.parse_args()
    seeds = order.seeds
    if order.picture is not None:
        draw(seeds, order.picture)
        return
    head = 'largest | rms | within | rms by deviation'
    sys.stdout.write(f'| cell | charge: {head} | time: {head} | false alarms |\n')
    for kind, tolerance in KINDS.items():
        metered.TOLERANCE = tolerance
        sys.stdout.write(f'| {kind} | {row(seeds)} |\n')
        sys.stdout.flush()


if __name__ == '__main__':
    main()
