"""Flights of the comparison of platforms, for the rows that need some of them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import final

from lta_config.schema.comparison_file import Comparison, load_comparison
from lta_config.schema.manoeuvre_file import load_manoeuvre
from lta_studies.platforms.pictures import called, following
from lta_studies.platforms.run import ABLATION, CONTESTANT, fly_job, Job, LIMIT, loop_of, Row
from lta_studies.platforms.summary import Cell, fastest, Mean
from lta_studies.reproduce.found import Value
from lta_studies.reproduce.recorded import record, way
from plotly.graph_objects import Figure

FILE = 'platforms'


@final
@dataclass(frozen=True, slots=True)
class Flights:
    """Some flights of the comparison."""

    comparison: Comparison
    rows: Sequence[Row]

    def of(self, name: str, manoeuvre: str) -> Cell:
        """Return all seeds of an entry in a manoeuvre."""
        return Cell([r for r in self.rows if r.job.name == name and r.job.manoeuvre == manoeuvre])

    def value(self, name: str, manoeuvre: str, figure: str, of: str = 'metrics') -> Value:
        """Return a figure of an entry with its interval; NaN where no seed has it."""
        cell = self.of(name, manoeuvre)
        found: Mean = cell.mean(figure, of)
        return Value(found.value, found.low, found.high, len(cell.rows))

    def held(self, name: str, manoeuvre: str) -> Value:
        """Return the share of flights that held a manoeuvre."""
        cell = self.of(name, manoeuvre)
        if len(cell.rows) == 1:
            return Value(cell.held.value, seeds=1)
        return Value(*cell.held, seeds=len(cell.rows))

    def picture(self, manoeuvre: str, names: Iterable[str]) -> Figure:
        """Return what was asked for and what each entry made of it, seed 1."""
        titles = {name: self.title(name) for name in names}
        shown = [
            replace(row, job=replace(row.job, kind=CONTESTANT))  # ablations beside contestants
            for row in self.rows
            if row.job.name in titles
        ]
        return following(shown, titles, load_manoeuvre(manoeuvre))

    def record(self, manoeuvre: str, names: Iterable[str], folder: Path) -> str:
        """Record the flight of seed 1 of each entry; return the page's way there."""
        until = load_manoeuvre(manoeuvre).until.si
        for name in names:
            loop = loop_of(Job(FILE, kind(self.comparison, name), name, manoeuvre, 1))
            record(loop, lambda loop: loop.world.elapsed > until, folder / name)
        return way(folder)

    def title(self, name: str) -> str:
        """Return what an entry is called."""
        contestant = self.comparison.contestants.get(name)
        return contestant.title if contestant else called(self.comparison, name)


def fly(pairs: Iterable[tuple[str, str]], seeds: int) -> Flights:
    """Return flights of entries in manoeuvres, each with the same seeds."""
    comparison = load_comparison(FILE)
    rows = [
        flown(Job(FILE, kind(comparison, name), name, manoeuvre, seed))
        for name, manoeuvre in pairs
        for seed in range(1, seeds + 1)
    ]
    return Flights(comparison, rows)


def limit(name: str, seeds: int) -> Value:
    """Return the highest speed up to which an entry held all that it was asked for. [m/s]"""
    comparison = load_comparison(FILE)
    asked = comparison.limits[name]
    rows = [
        flown(Job(FILE, LIMIT, name, asked.manoeuvre, seed, speed))
        for speed in asked.speeds.vector
        for seed in range(1, seeds + 1)
    ]
    return Value(fastest(comparison, rows, name)[0], seeds=seeds)


@cache
def flown(job: Job) -> Row:
    """Return a flight; rows that share one fly it once."""
    return fly_job(job)


def kind(comparison: Comparison, name: str) -> str:
    """Return which kind of entry has a name."""
    return CONTESTANT if name in comparison.contestants else ABLATION
