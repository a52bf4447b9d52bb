# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Rank five platforms by six criteria, each from a flown task or from the vehicle file."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import combinations
import math
from typing import Final

from lta_config.command_line import format_lta_command
from lta_config.constants import AIR_DENSITY, STANDARD_GRAVITY
from lta_model import mass_properties
from lta_model.propulsion import select_lifting_rotors
from lta_model.vehicle import Vehicle
from lta_report.drawing import create_figure
from lta_report.palette import GRID, INK, PAPER, TRUTH
from lta_studies.platforms.flight import build_entrant
from lta_studies.reproduce.manoeuvres import (
    ComparisonFlights,
    entry_title,
    find_speed_limit,
    fly_entries,
    load_scene,
    sample_gtmab,
)
from lta_studies.reproduce.study_result import (
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)
import numpy as np
from plotly.graph_objects import Figure, Heatmap

LOW, MEDIUM_LOW, MEDIUM, HIGH = range(4)
RANK_WORDS: Final = ('Low', 'Medium Low', 'Medium', 'High')
# Seed paper, table of platforms: planar, vertical, attitude, endurance, size, complexity.
RANKED: Final = {
    'multirotor': (HIGH, HIGH, HIGH, LOW, LOW, LOW),
    'skye': (MEDIUM, MEDIUM, MEDIUM, HIGH, HIGH, HIGH),
    'sblimp': (MEDIUM_LOW, MEDIUM, MEDIUM_LOW, HIGH, MEDIUM, MEDIUM),
    'gtmab': (MEDIUM_LOW, MEDIUM, HIGH, HIGH, MEDIUM, LOW),
    'beavis': (HIGH, MEDIUM_LOW, MEDIUM_LOW, HIGH, MEDIUM, LOW),
}
# Unit in the plot, factor from SI, and whether a larger value ranks higher.
CRITERIA: Final = {
    'planar': ('m/s', 1.0, False), 'vertical': ('m', 1.0, False),
    'attitude': ('°', 180.0 / math.pi, False), 'endurance': ('%', 100.0, False),
    'size': ('m', 1.0, True), 'complexity': ('', 1.0, True),
}  # fmt: skip
ABILITY_MANOEUVRES: Final = {'planar': 'cruise', 'vertical': 'climb', 'attitude': 'turn'}
PARALLEL_COSINE: Final = math.cos(math.radians(5.0))  # rotors within 5 deg share a thrust line
LIMIT_SEEDS: Final = 3
PLATFORM_CAPTION: Final = (
    'Columns: rms error in a cruise at 0.5 m/s, a climb of 1.5 m and a turn by 90°; share '
    'of the weight that rotors carry while hovering; largest dimension; number of thrust '
    "directions. In brackets: value in the paper's table. Darker cells rank higher within a "
    'column.'
)
FOLLOWED_PANELS: Final = {
    'cruise': ('Planar: fly at 0.5 m/s', 'Speed along the course. Dashed: setpoint; seed 1.'),
    'climb': ('Vertical: rise by 1.5 m', 'Height above the start. Dashed: setpoint; seed 1.'),
    'turn': ('Attitude: turn by 90°', 'Heading. Dashed: setpoint; seed 1.'),
}


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Measure the paper's table, and how well its ranking is reproduced."""
    manoeuvres = () if request.quick else tuple(ABILITY_MANOEUVRES.values())
    flights = fly_entries([(name, each) for name in RANKED for each in manoeuvres], request.seeds)
    measured = {
        criterion: {name: measure(name) for name in RANKED}
        for criterion, measure in build_criterion_functions(flights).items()
        if criterion not in ABILITY_MANOEUVRES or ABILITY_MANOEUVRES[criterion] in manoeuvres
    }
    values = {
        f'{name}_{criterion}': value
        for criterion, each in measured.items()
        for name, value in each.items()
    }
    for criterion, each in measured.items():
        values[f'{criterion}_order'] = MeasuredValue(
            rank_concordance(criterion, each), seeds=request.seeds
        )
    if not request.quick:
        values['sblimp_limit'] = find_speed_limit('sblimp', min(request.seeds, LIMIT_SEEDS))
    command = format_lta_command('reproduce', 'platforms')
    titles = [entry_title(name) for name in RANKED]
    pictures = [
        StudyPicture(
            'table',
            'Six criteria, measured',
            PLATFORM_CAPTION,
            plot_table(titles, measured),
            command,
        )
    ]
    pictures += [
        StudyPicture(each, *FOLLOWED_PANELS[each], flights.plot_tracking(each, RANKED), command)
        for each in manoeuvres
    ]  # fmt: skip
    return RowStudyResult(values, pictures, draws=draw_orders(request, measured))


def draw_orders(
    request: RowStudyRequest, measured: Mapping[str, Mapping[str, MeasuredValue]]
) -> dict[str, list[float | str]]:
    """
    Return the concordance of the vehicle files' criteria in every draw of GT-MAB.

    The other platforms stay as measured.
    """
    samples = [sample_gtmab(request, seed).vehicle for seed in request.draw_seeds]
    return {
        f'{criterion}_order': [
            rank_concordance(
                criterion, {**measured[criterion], 'gtmab': MeasuredValue(measure(vehicle))}
            )
            for vehicle in samples
        ]
        for criterion, measure in OF_VEHICLE.items()
    }


def build_criterion_functions(
    flights: ComparisonFlights,
) -> dict[str, Callable[[str], MeasuredValue]]:
    """Return a function of the platform name for each criterion."""

    def of_vehicle(measure: Callable[[Vehicle], float], name: str) -> MeasuredValue:
        entrant = build_entrant(load_scene()[0].contestants[name], AIR_DENSITY)
        return MeasuredValue(measure(entrant.vehicle))

    return {
        'planar': lambda name: flights.metric_value(name, 'cruise', 'rms'),
        'vertical': lambda name: flights.metric_value(name, 'climb', 'rms'),
        'attitude': lambda name: flights.metric_value(name, 'turn', 'rms'),
        **{criterion: partial(of_vehicle, each) for criterion, each in OF_VEHICLE.items()},
    }


def thrust_to_weight(vehicle: Vehicle) -> float:
    """Return the total rotor thrust in hover divided by the weight [1]."""
    own, per_newton = select_lifting_rotors(vehicle.rotors, vehicle.file.aero.coupling)
    # `per_newton` is the total lift [N] if each lifting rotor gives 1 N.
    thrust = max(vehicle.heaviness, 0.0) * STANDARD_GRAVITY / per_newton * len(own)
    return thrust / (vehicle.mass * STANDARD_GRAVITY)


def greatest_extent(vehicle: Vehicle) -> float:
    """Return the largest extent of the hull or between two rotors [m]."""
    places = [rotor.place for rotor in vehicle.rotors]
    span = max(math.dist(a, b) for a, b in combinations(places, 2))
    if vehicle.file.hull.shape == 'none':
        return span
    return max(span, 2.0 * max(mass_properties.half_axes(vehicle.file.hull)))


def count_thrust_lines(vehicle: Vehicle) -> float:
    """Return the number of different lines of thrust [1]."""
    lines: list[tuple[float, float, float]] = []
    for rotor in vehicle.rotors:
        # Opposite axes count as the same line, hence the absolute value.
        if all(abs(float(np.dot(rotor.axis, other))) < PARALLEL_COSINE for other in lines):
            lines.append(rotor.axis)
    return float(len(lines))


OF_VEHICLE: Final[Mapping[str, Callable[[Vehicle], float]]] = {
    'endurance': thrust_to_weight, 'size': greatest_extent, 'complexity': count_thrust_lines,
}  # fmt: skip


def rank_concordance(criterion: str, values: Mapping[str, MeasuredValue]) -> float:
    """Return the share of pairs ranked by the paper that are measured in the same order."""
    column = list(CRITERIA).index(criterion)
    # Column 2: whether a larger value ranks higher
    sign = 1.0 if CRITERIA[criterion][2] else -1.0
    pairs = [
        (higher, lower)
        for higher in RANKED
        for lower in RANKED
        if RANKED[higher][column] > RANKED[lower][column]
    ]
    right = [
        sign * (require_number(values[a]) - require_number(values[b])) > 0.0 for a, b in pairs
    ]
    return sum(right) / len(right)


def require_number(value: MeasuredValue) -> float:
    """Return the number of a value that is not a word."""
    assert not isinstance(value.value, str)
    return value.value


def plot_table(
    titles: Sequence[str], measured: Mapping[str, Mapping[str, MeasuredValue]]
) -> Figure:
    """Plot the paper's table with the measured values."""
    figure = create_figure()
    shades, texts = [], []
    for name in RANKED:
        row, words = [], []
        for criterion, by_platform in measured.items():
            unit, factor, more = CRITERIA[criterion]
            ordered = sorted(
                (require_number(each) for each in by_platform.values()), reverse=not more
            )
            row.append(ordered.index(require_number(by_platform[name])))
            paper = RANK_WORDS[RANKED[name][list(CRITERIA).index(criterion)]]
            words.append(f'{factor * require_number(by_platform[name]):.3g} {unit}<br>({paper})')
        shades.append(row)
        texts.append(words)
    figure.add_trace(
        Heatmap(
            z=shades, x=list(measured), y=list(titles), text=texts,
            texttemplate='%{text}', textfont={'color': INK, 'size': 9},
            # Only rank 0 has the colour of the page.
            colorscale=[[0.0, PAPER], [0.001, GRID], [1.0, TRUTH]], opacity=0.4, showscale=False,
            xgap=2, ygap=2, hovertemplate='%{y}, %{x}: %{text}<extra></extra>',
        )
    )  # fmt: skip
    figure.update_yaxes(autorange='reversed', showgrid=False, ticksuffix=' ')
    figure.update_xaxes(side='top', showgrid=False)
    return figure.update_layout(hovermode='closest', margin={'l': 110, 'r': 20})
