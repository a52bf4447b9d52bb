"""
Fly many seeds through the whole graph, and compare their spread with the paper's indoor flight.

Not tuned to either of the paper's figures: 7.3 m in 8.4 s is 0.87 m/s, not the 0.5 m/s it says.
"""

from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path
import statistics
import tempfile
from typing import Final

from lta_data.bag import open_flight
from lta_flight.flight import fly_once
from lta_flight.progress import FlightProgress
from lta_flight.report.results import compute_results
from lta_flight.report.view import FlightView
from rich.console import Console

from campaigns.harness import Campaign, Case, Row, Rows

PAPER: Final = {'path_length': 7.3, 'search_time': 8.4, 'forward_airspeed': 0.5}


def run(case: Case, options: Namespace) -> Row:
    """Return the outcome and the figures of a seed."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / 'flight'
        watcher = FlightProgress(Console(quiet=True))
        flight = fly_once('gtmab', case.kind, 'bag', case.number, watcher, out=out)
        results = compute_results(FlightView(open_flight(flight.bag)))
    return {'outcome': flight.outcome} | {name: getattr(results, name) for name in PAPER}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the spread of each figure over the flights that reached the lamp."""
    reached = [row for row in rows.values() if row.get('outcome') == 'reached']
    yield f'{len(reached)} of {len(rows)} flights reached the lamp.'
    yield ''
    yield '| | mean | standard deviation | paper |'
    yield '|---|---|---|---|'
    for name, paper in PAPER.items():
        values = [row[name] for row in reached if row[name] is not None]
        mean = f'{statistics.mean(values):.2f}' if values else '-'
        spread = f'{statistics.stdev(values):.2f}' if len(values) > 1 else '-'
        yield f'| {name.replace("_", " ")} | {mean} | {spread} | {paper} |'


CAMPAIGN: Final = Campaign(lambda options: ['lamp_room'], run, list_table, each=20)
