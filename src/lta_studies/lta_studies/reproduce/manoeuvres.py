# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly the entries of the platform comparison for the rows that need them, and plot them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
import math
from typing import Any, Final, final, NamedTuple

from lta_config.schema.comparison_file import (
    ComparisonFile,
    load_comparison,
    load_maneuver_file,
    ManeuverFile,
)
from lta_flight.sweep.statistics import student_interval, wilson_interval
from lta_model.scenario import load_scenario, Scenario
from lta_report.charts import ChartAxis, Curve, DASHED, draw_curves
from lta_report.drawing import decimate_line
from lta_report.palette import ESTIMATE, GOOD, LAMP, RAW, SETPOINT, SOFT, STRENGTH, TIME, TRUTH
from lta_studies.platforms.flight import (
    build_entrant,
    COLUMN_OF_SIGNAL,
    Entrant,
    fly_maneuver,
    ManeuverFlight,
    SPEED_COLUMN,
    TrackingMetrics,
)
from lta_studies.reproduce.study_result import MeasuredValue, RowStudyRequest
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure

Array = NDArray[np.float64]
COMPARISON_FILE: Final = 'platforms'  # the comparison file
TRACE_DECIMATION: Final = 10  # decimation of the traces for plots


@cache
def load_scene() -> tuple[ComparisonFile, Scenario]:
    """Return the comparison and the scenario of its flights."""
    comparison = load_comparison(COMPARISON_FILE)
    return comparison, load_scenario(comparison.scenario)


@cache
# Cached, as all seeds and manoeuvres share the entrant.
def build_entry(name: str, *, limited: bool = False) -> Entrant:
    """Return a contestant, an ablation of one, or a contestant at its limit."""
    comparison, scenario = load_scene()
    density = scenario.air.density
    if name in comparison.contestants and not limited:
        return build_entrant(comparison.contestants[name], density)
    change = comparison.limits[name] if limited else comparison.ablations[name]
    return build_entrant(comparison.contestants[change.of], density, change)


def replace_speeds(manoeuvre: ManeuverFile, speed: float | None) -> ManeuverFile:
    """Return the manoeuvre with its positive speeds replaced [m/s]."""
    if speed is None:
        return manoeuvre
    rows = [
        row.model_copy(update={'speed': row.speed.model_copy(update={'value': speed})})
        # Rows with speed 0 are the hover before or after, which stays.
        if row.speed.si > 0.0 else row
        for row in manoeuvre.course
    ]  # fmt: skip
    return manoeuvre.model_copy(update={'course': rows})


class EntryFlight(NamedTuple):
    """One flight of an entry; traces are kept for seed 1 only."""

    name: str
    manoeuvre: str
    seed: int
    held: bool
    metrics: TrackingMetrics
    speed: float  # along the course, mean of the last quarter [m/s]
    # Time, altitude, heading and speed, shape (n, 4)
    flown: Array | None = None
    asked: Array | None = None


@cache
# Deterministic by its seed, so a cached result equals a new one.
def fly_entry(name: str, manoeuvre: str, seed: int, speed: float | None = None) -> EntryFlight:
    """Fly an entry once for all rows that share it; a speed is that of a limit [m/s]."""
    flight = fly_maneuver(
        build_entry(name, limited=speed is not None),
        load_scene()[1],
        replace_speeds(load_maneuver_file(manoeuvre), speed),
        seed,
    )
    last = flight.flown[3 * len(flight.flown) // 4 :, SPEED_COLUMN]
    tables = (flight.flown, flight.asked) if seed == 1 else ()
    return EntryFlight(
        name, manoeuvre, seed, flight.is_successful, flight.metrics, float(last.mean()),
        *(table[::TRACE_DECIMATION] for table in tables),
    )  # fmt: skip


PLATFORM_COLOURS: Final = (
    TRUTH, ESTIMATE, GOOD, LAMP, TIME[0], TIME[2], SOFT, STRENGTH[1], STRENGTH[3], TIME[3], RAW,
)  # fmt: skip
SIGNAL_UNITS: Final = {'altitude': 'm', 'heading': '\N{DEGREE SIGN}', 'speed': 'm/s'}
SIGNAL_WORDS: Final = {'altitude': 'rise', 'heading': 'heading', 'speed': 'speed along the course'}


def draw_tracking(
    flights: Sequence[EntryFlight], titles: Mapping[str, str], manoeuvre: ManeuverFile
) -> Figure:
    """Plot setpoint and response of each entry in a manoeuvre, for seed 1."""
    column, unit = COLUMN_OF_SIGNAL[manoeuvre.judge], SIGNAL_UNITS[manoeuvre.judge]

    def plot(name: str, table: Array | None, colour: str, **look: Any) -> Curve:
        assert table is not None
        values = scale_column(manoeuvre, table, table[0, column], column)
        line = decimate_line(table[:, 0], values)
        return Curve(name, *line, colour, f'%{{y:.3~f}} {unit}', **look)

    shape = {'line_shape': 'hv' if manoeuvre.between == 'step' else 'linear'}
    curves = [plot('setpoint', flights[0].asked, SETPOINT, dash=DASHED, more=shape)]
    for flight in flights:
        # Index into all titles, so that an entry has the same colour in every plot.
        colour = PLATFORM_COLOURS[list(titles).index(flight.name) % len(PLATFORM_COLOURS)]
        title = titles[flight.name]
        curves.append(plot(title, flight.flown, colour, label=title))
    axis = ChartAxis(f'{SIGNAL_WORDS[manoeuvre.judge]} [{unit}]')
    return draw_curves(curves, ChartAxis('time [s]'), axis).update_layout(margin={'r': 150})


def scale_column(manoeuvre: ManeuverFile, table: Array, first: float, column: int) -> Array:
    """Return a column in display units: rise [m], heading [deg] or speed [m/s]."""
    values = table[:, column]
    if manoeuvre.judge == 'altitude':
        return values - float(first)
    return values * (180.0 / math.pi) if manoeuvre.judge == 'heading' else values


@final
@dataclass(frozen=True, slots=True)
class ComparisonFlights:
    """Some flights of the comparison."""

    flights: Sequence[EntryFlight]

    def select(self, name: str, manoeuvre: str) -> list[EntryFlight]:
        """Return all seeds of an entry in a manoeuvre."""
        return [f for f in self.flights if (f.name, f.manoeuvre) == (name, manoeuvre)]

    def metric_value(self, name: str, manoeuvre: str, figure: str) -> MeasuredValue:
        """Return a metric of an entry with its interval; NaN if no seed has it."""
        flights = self.select(name, manoeuvre)
        values = [float(getattr(each.metrics, figure)) for each in flights]
        mean = student_interval([value for value in values if math.isfinite(value)])
        return MeasuredValue(*mean, len(flights))

    def success_share(self, name: str, manoeuvre: str) -> MeasuredValue:
        """Return the share of flights that held a manoeuvre."""
        flights = self.select(name, manoeuvre)
        share = wilson_interval(sum(each.held for each in flights), len(flights))
        # One flight gives no interval.
        if len(flights) == 1:
            return MeasuredValue(share.value, seeds=1)
        return MeasuredValue(*share, seeds=len(flights))

    def plot_tracking(self, manoeuvre: str, names: Iterable[str]) -> Figure:
        """Plot setpoint and response of each entry, for seed 1."""
        titles = {name: entry_title(name) for name in names}
        first = [each for name in titles for each in self.select(name, manoeuvre)[:1]]
        return draw_tracking(first, titles, load_maneuver_file(manoeuvre))


def entry_title(name: str) -> str:
    """Return the title of an entry; of an ablation 'beavis_neutral' it is 'BEAVIS neutral'."""
    contestants = load_scene()[0].contestants
    if name in contestants:
        return contestants[name].title
    first, _, rest = name.partition('_')
    return f'{contestants[first].title.split()[0]} {rest.replace("_", " ")}'


def fly_entries(pairs: Iterable[tuple[str, str]], seeds: int) -> ComparisonFlights:
    """Fly pairs of entry and manoeuvre, each with the same seeds."""
    return ComparisonFlights(
        [fly_entry(*pair, seed) for pair in pairs for seed in range(1, seeds + 1)]
    )


def sample_gtmab(request: RowStudyRequest, seed: int) -> Entrant:
    """Return GT-MAB with a draw of what is assumed."""
    comparison, scenario = load_scene()
    changed = comparison.contestants['gtmab'].model_copy(
        update={'changes': request.draw_changes(seed)}
    )
    return build_entrant(changed, scenario.air.density)


def fly_gtmab_draws(
    request: RowStudyRequest, manoeuvres: Sequence[str]
) -> dict[str, list[ManeuverFlight]]:
    """Fly GT-MAB once in every draw of what is assumed; return its flights by manoeuvre."""
    _, scenario = load_scene()
    samples = {seed: sample_gtmab(request, seed) for seed in request.draw_seeds}
    return {
        name: [
            fly_maneuver(entrant, scenario, load_maneuver_file(name), seed)
            for seed, entrant in samples.items()
        ]
        for name in manoeuvres
    }


def draw_gtmab(
    request: RowStudyRequest, manoeuvres: Sequence[str]
) -> dict[str, list[float | str]]:
    """Fly GT-MAB once in every draw of what is assumed; return what it held, by measure."""
    return {
        f'gtmab_{name}_held': [float(each.is_successful) for each in flights]
        for name, flights in fly_gtmab_draws(request, manoeuvres).items()
    }


def find_speed_limit(name: str, seeds: int) -> MeasuredValue:
    """Return the highest speed up to which an entry held all commanded speeds [m/s]."""
    limit, held = load_scene()[0].limits[name], 0.0
    for speed in limit.speeds.vector:
        numbers = range(1, seeds + 1)
        # A speed held above one that failed does not count: the range must be continuous.
        if not all(fly_entry(name, limit.manoeuvre, seed, speed).held for seed in numbers):
            break
        held = speed
    return MeasuredValue(held, seeds=seeds)
