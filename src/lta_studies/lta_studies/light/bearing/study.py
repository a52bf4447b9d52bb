"""
Repeat the paper's study of the number of photodiodes with both estimators.

The lamp is 3 m away and the drone is 45 degrees off the lamp's axis, or straight ahead of it: the
paper does not say which. The ring turns through 16 directions with 50 readings each; the paper
gives medians. The gains of the one vehicle are drawn once, from the seed.

Some of the paper's statements need an explanation. With ideal cosine diodes the weighted mean is
exact for any even ring of four or more, whatever the pedestal (`lta_vlc.bearing`). With equal
diodes of any response a ring of eight is exact at all 16 directions, which are its own axes and
the bisectors between them. Errors in some directions only can therefore only come from a response
other than a cosine, from unequal gains, and from reflections. Steady sunlight adds only noise at
the lamp's frequency: "all worse from sunlight" is noise or saturation, and "4 better than indoors"
is due to missing reflections.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
import math
from typing import Any, Final, final

from lta_report.charts import ChartAxis, Curve, DOTTED, draw_curves
from lta_report.formatting import Tile
from lta_report.palette import GOOD, LAMP, TRUTH
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_report.request import option, StudyRequest, StudyRun, VEHICLE
from lta_report.study import hash_inputs, Study
from lta_report.study_store import StoreFormat
from lta_studies.light.bearing.bench import BEARING_PLACES, BearingBench, build_flight_spec, Pose
from lta_studies.light.bearing.report import format_degrees
from lta_studies.light.bearing.run import error_quantile, extract_column
import numpy as np
from plotly.graph_objects import Figure
from pydantic import TypeAdapter

DIRECTION_COUNT: Final = 16
STUDY_DISTANCE: Final = 3.0  # m
# Off the lamp's axis, where reflections turn the mean most. On the axis of a symmetric room they
# are symmetric, too.
STUDY_OFF_AXIS: Final = math.radians(45.0)
STUDY_HEIGHT: Final = 0.5  # of the hull centre, that of the paper's flights [m]
READINGS_PER_DIRECTION: Final = 50
RING_COUNTS: Final = (4, 8, 16)


@final
class RingStudyRequest(StudyRequest, command='light study', quick={'readings': 5}):
    """
    Repeat the paper's study of the number of photodiodes, with its estimator and with ours.

    Simulates 4, 8 and 16 diodes with the lamp 3 m away in 16 directions, 50 readings each, indoors
    and outdoors. Reports median errors; "lta reproduce photodiodes" judges the paper's statements.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta light study --seed 7
    """

    vehicle: str = VEHICLE
    readings: int = option(
        'Number of photodiode readings in each direction.',
        default=READINGS_PER_DIRECTION,
        low=1,
        high=10_000,
    )
    seed: int = option('Random seed.', default=1, low=0)
    aside: float = option(
        "Angle between the lamp's axis and the drone, degrees.",
        default=math.degrees(STUDY_OFF_AXIS),
        low=0, high=60,
    )  # fmt: skip

    def run(self, run: StudyRun) -> Report:
        """Return the report of all rings."""
        # Also checks that the vehicle fits the scenes before any work
        specs = [build_flight_spec(place, self.vehicle, 1) for place in BEARING_PLACES.values()]
        turned = math.radians(self.aside)
        compute = partial(study_case, self.vehicle, self.readings, self.seed, turned)
        inputs = (self.readings, self.seed, turned, *(spec.contents for spec in specs))
        cases = list(product(BEARING_PLACES, RING_COUNTS))
        study = Study(compute, str, RING_STORE, 'rings')
        rings = run.run_study(study, hash_inputs(*inputs), cases)
        return build_report(rings, self.vehicle, self.readings, self.seed, turned)


@final
@dataclass(frozen=True, slots=True)
class RingStudy:
    """Results of one ring in one place."""

    place: str  # name in `BEARING_PLACES`
    count: int  # number of diodes
    # Median error in each direction [rad]
    paper: tuple[float, ...]
    ours: tuple[float, ...]
    snr: float  # median SNR of the best diode

    def to_json(self) -> dict[str, Any]:
        """Convert the study to JSON; angles in rad."""
        return {
            'place': self.place, 'diodes': self.count, 'snr': self.snr,
            'paper': list(self.paper), 'fit': list(self.ours),
        }  # fmt: skip


def list_directions() -> list[float]:
    """Return the true directions of the lamp, seen from the ring. [rad]"""
    return [math.tau * k / DIRECTION_COUNT for k in range(DIRECTION_COUNT)]


RING_STORE: Final = StoreFormat(
    'rings.jsonl', 'study', 'study of photodiodes', TypeAdapter(RingStudy)
)


def study_case(
    vehicle: str, readings: int, seed: int, aside: float, ring: tuple[str, int]
) -> RingStudy:
    """Study a ring (place, number of diodes) of a vehicle, `aside` of the lamp's axis. [rad]"""
    place, count = ring
    bench = BearingBench(build_flight_spec(BEARING_PLACES[place], vehicle, count))
    return study_ring(bench, place, count, readings, seed, aside)


def study_ring(
    bench: BearingBench,
    place: str,
    count: int,
    readings: int,
    seed: int,
    aside: float = STUDY_OFF_AXIS,
) -> RingStudy:
    """Study one ring in all directions, `aside` of the lamp's axis. [rad]"""
    # The same draws indoors and outdoors: only the place differs.
    chance = np.random.default_rng([seed, count])
    diodes = bench.sample_diode_gains(chance)
    paper, ours, snrs = [], [], []
    for direction in list_directions():
        pose = pose_for_lamp_direction(bench, direction, aside)
        blocks = [bench.estimate_block_bearing(pose, diodes, chance) for _ in range(readings)]
        paper.append(error_quantile(extract_column(blocks, 'paper'), 50.0))
        ours.append(error_quantile(extract_column(blocks, 'ours'), 50.0))
        snrs.append(float(np.median(extract_column(blocks, 'snr'))))
    return RingStudy(place, count, tuple(paper), tuple(ours), float(np.median(snrs)))


def pose_for_lamp_direction(
    bench: BearingBench, direction: float, aside: float = STUDY_OFF_AXIS
) -> Pose:
    """Return the level pose, `aside` of the axis, that has the lamp in a direction. [rad]"""
    x, y, _ = bench.scenario.goal_lamp.position.vector
    ahead_x, ahead_y, _ = bench.scenario.goal_lamp.facing.vector
    facing = math.atan2(ahead_y, ahead_x) + aside
    # Half the heading: from the drone, the lamp is at facing + pi in the map.
    half = 0.5 * (facing + math.pi - direction)
    # The ring is below the hull centre, so a level ring has the same horizontal position.
    return (
        x + STUDY_DISTANCE * math.cos(facing), y + STUDY_DISTANCE * math.sin(facing), STUDY_HEIGHT,
        0.0, 0.0, math.sin(half), math.cos(half),
    )  # fmt: skip


def count_accurate_directions(errors: Sequence[float], limit: float) -> int:
    """Return the number of directions with a median error below a limit."""
    return sum(error < limit for error in errors)


RING_COLOURS: Final = dict(zip(RING_COUNTS, (LAMP, TRUTH, GOOD), strict=True))
RING_HEADS: Final = (
    'place', 'diodes', 'SNR', 'paper: median [°]', 'worst [°]', 'below 2°', 'fit: median [°]',
    'worst [°]', 'below 2°',
)  # fmt: skip
RING_CAPTION: Final = (
    'Median bearing error in each of 16 directions. Full lines: our fit. Dotted: the '
    'weighted mean of the paper.'
)
RING_METHOD: Final = (
    'The hull is level at 0.5 m and turns through 16 directions. The diode gains of the vehicle '
    'are drawn once. Errors are medians over the readings; each reading is one block of ADC '
    'samples with its own noise.'
)


def describe_method(aside: float) -> str:
    """Describe the set-up, with the drone `aside` of the lamp's axis. [rad]"""
    where = f'{math.degrees(aside):g} degrees off its axis' if aside else 'on its axis'
    return f'The lamp is {STUDY_DISTANCE:g} m away and the drone is {where}. {RING_METHOD}'


def build_report(
    studies: Sequence[RingStudy], vehicle: str, readings: int, seed: int, aside: float
) -> Report:
    """Return the report of a study of all rings, `aside` of the lamp's axis. [rad]"""
    # The headline uses the paper's main setup
    eight = next(each for each in studies if (each.place, each.count) == ('indoor', 8))
    return Report(
        command='light study',
        subject='number of photodiodes',
        headline=f'Indoors with eight diodes, {format_median_errors(eight)}.',
        introduction=f'{DIRECTION_COUNT} directions to the lamp, {readings} readings in each.',
        tiles=build_tiles(studies),
        blocks=(
            *(
                Picture(
                    place, f'{place.capitalize()}: {BEARING_PLACES[place].about}', RING_CAPTION,
                    plot_errors(studies, place), height=420,
                )
                for place in BEARING_PLACES
            ),
            build_ring_table(studies),
            TextSection('Method', (describe_method(aside),)),
        ),
        data={
            'vehicle': vehicle, 'readings': readings, 'seed': seed, 'aside': aside,
            'rings': [each.to_json() for each in studies],
        },
        facts={'vehicle': vehicle, 'seed': str(seed)},
    )  # fmt: skip


def format_median_errors(ring: RingStudy) -> str:
    """Return the part of a headline with the median errors of both estimators."""
    return (
        f'the median bearing error is {format_degrees(median_error(ring.ours))}° for our fit and '
        f'{format_degrees(median_error(ring.paper))}° for the weighted mean of the paper'
    )


def median_error(errors: Sequence[float]) -> float:
    """Return the median over the directions; NaN if one has no bearing."""
    return float(np.median(errors))


def build_ring_table(studies: Sequence[RingStudy]) -> TextTable:
    """Return the table of errors over all directions."""
    rows = []
    for each in studies:
        cells = [each.place, str(each.count), f'{each.snr:.0f}']
        for errors in (each.paper, each.ours):
            below = f'{count_accurate_directions(errors, math.radians(2.0))} of {DIRECTION_COUNT}'
            cells += [format_degrees(median_error(errors)), format_degrees(max(errors)), below]
        rows.append(cells)
    return TextTable(f'Bearing errors over {DIRECTION_COUNT} directions', RING_HEADS, rows)


def build_tiles(studies: Sequence[RingStudy]) -> list[Tile]:
    """Return tiles with the worst direction of the fit for each ring."""
    return [
        Tile(
            f'{each.place}, {each.count} diodes', format_degrees(max(each.ours)), '°',
            f'worst direction; paper {format_degrees(max(each.paper))}°',
        )
        for each in studies
    ]  # fmt: skip


def plot_errors(studies: Sequence[RingStudy], place: str) -> Figure:
    """Plot the error by direction for each ring."""
    angles = np.degrees(list_directions())
    curves = [
        Curve(
            f'{each.count} diodes, {name}', angles, np.degrees(errors), RING_COLOURS[each.count],
            '%{y:.2f}°', 'lines+markers', dash, 1.4, 5,
        )
        for each in studies
        if each.place == place
        for name, errors, dash in (('paper', each.paper, DOTTED), ('fit', each.ours, 'solid'))
    ]  # fmt: skip
    direction = ChartAxis('direction of the lamp, seen from the ring [°]', more={'dtick': 45})
    return draw_curves(curves, direction, ChartAxis('median error [°]', zero=True))
