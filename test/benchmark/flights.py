"""
Fly many seeds through the whole graph: `python test/benchmark/flights.py [SEEDS]` (20 by default).

Prints a row a seed and the spread, beside the paper's indoor flight. Not tuned to either of the
paper's figures: 7.3 m in 8.4 s is 0.87 m/s, not the 0.5 m/s it says.
"""

from pathlib import Path
import statistics
import sys
import tempfile

from graph import Silent
from lta_analysis.bag import open_flight
from lta_analysis.flight import fly_once, Order
from lta_analysis.report.results import Results, results_of
from lta_analysis.report.view import View

PAPER = {'path_length': 7.3, 'search_time': 8.4, 'airspeed': 0.5}


def flown(seed: int) -> tuple[str, Results]:
    """Return the outcome and the results of one seed."""
    with tempfile.TemporaryDirectory() as folder:
        order = Order('gtmab', 'lamp_room', 'bag', seed, 'lockstep', Path(folder) / 'flight')
        flight = fly_once(order, Silent())
        return flight.outcome, results_of(View(open_flight(flight.bag)))


def main(count: int) -> None:
    """Print the table."""
    say = sys.stdout.write
    flights = []
    for seed in range(1, count + 1):
        outcome, results = flown(seed)
        flights.append((outcome, results))
        figures = '  '.join(f'{name} {getattr(results, name) or 0.0:5.2f}' for name in PAPER)
        say(f'seed {seed:<3} {outcome:<9} {figures}\n')
        sys.stdout.flush()
    reached = [results for outcome, results in flights if outcome == 'reached']
    say(f'reached {len(reached)} of {count}\n')
    for name, paper in PAPER.items():
        values = [getattr(results, name) for results in reached]
        spread = statistics.stdev(values) if len(values) > 1 else 0.0
        say(f'{name:<12} mean {statistics.mean(values):.2f} +- {spread:.2f}, paper {paper}\n')


if __name__ == '__main__':
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
