"""
Fly many seeds through the whole graph: `make flights ARGS=SEEDS` (20 by default).

Prints a row a seed and the spread, beside the paper's indoor flight. Not tuned to either of the
paper's figures: 7.3 m in 8.4 s is 0.87 m/s, not the 0.5 m/s it says.
"""

from pathlib import Path
import statistics
import sys
import tempfile

from graph import Silent
from lta_config.errors import BadInput
from lta_data.bag import open_flight
from lta_flight.flight import FlightRequest, fly_once
from lta_flight.report.results import compute_results, FlightResults
from lta_flight.report.view import FlightView

PAPER = {'path_length': 7.3, 'search_time': 8.4, 'airspeed': 0.5}


def flown(seed: int) -> tuple[str, FlightResults]:
    """Return the outcome and the results of one seed; a flight that broke has none."""
    with tempfile.TemporaryDirectory() as folder:
        order = FlightRequest(
            'gtmab', 'lamp_room', 'bag', seed, 'lockstep', Path(folder) / 'flight'
        )
        try:
            flight = fly_once(order, Silent())
            return flight.outcome, compute_results(FlightView(open_flight(flight.bag)))
        except BadInput as error:
            sys.stderr.write(f'seed {seed}: {error}\n')
            return 'failed', FlightResults()


def cell(value: float | None) -> str:
    """Return a figure of the table; a dash where there is none."""
    return '    -' if value is None else f'{value:5.2f}'


def summary(flights: list[tuple[str, FlightResults]]) -> list[str]:
    """Return how many reached the lamp, and the spread of each figure over those."""
    reached = [results for outcome, results in flights if outcome == 'reached']
    lines = [f'reached {len(reached)} of {len(flights)}']
    for name, paper in PAPER.items():
        told = [getattr(results, name) for results in reached]
        values = [value for value in told if value is not None]
        mean = statistics.mean(values) if values else None
        spread = statistics.stdev(values) if len(values) > 1 else None
        lines.append(f'{name:<12} mean {cell(mean)} +- {cell(spread)}, paper {paper}')
    return lines


def main(count: int) -> None:
    """Print the table."""
    flights = []
    for seed in range(1, count + 1):
        outcome, results = flown(seed)
        flights.append((outcome, results))
        figures = '  '.join(f'{name} {cell(getattr(results, name))}' for name in PAPER)
        sys.stdout.write(f'seed {seed:<3} {outcome:<9} {figures}\n')
        sys.stdout.flush()
    sys.stdout.write('\n'.join(summary(flights)) + '\n')


if __name__ == '__main__':
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
