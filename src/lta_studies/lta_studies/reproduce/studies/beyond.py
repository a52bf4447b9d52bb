"""Study the paper's future work, and compare our estimator and strategy with its own."""

from pathlib import Path
from typing import Final

from lta_config.command_line import format_lta_command
from lta_report.request import StudyRun
from lta_report.study import StudyOptions
from lta_studies.light.bearing.bench import BEARING_PLACES, BearingBench, build_flight_spec
from lta_studies.light.bearing.study import READINGS_PER_DIRECTION, RingStudy, study_ring
from lta_studies.light.evaluation.pictures import (
    fly_again,
    plot_paper_comparison,
    plot_tracks,
    select_track_seed,
)
from lta_studies.mission.flyer import AWARE, NAIVE
from lta_studies.mission.pictures import draw_charge
from lta_studies.mission.run import (
    filter_by_schedule,
    flight_time_ratio,
    load_request,
    run_missions,
)
from lta_studies.reproduce.flights import (
    FlightGroup,
    fly_group,
    format_command,
    measure_success_share,
    summarize_cell,
    thin_annotations,
)
from lta_studies.reproduce.study_result import (
    average_over_seeds,
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)
from rich.console import Console

BEYOND_STRATEGIES: Final = ('bag', 'homing')
BEYOND_WINDS: Final = {  # cases: mean plus one deviation is 60 or 90 % of the top airspeed
    'head_60': 'head', 'head_90': 'strong_head', 'cross_60': 'cross', 'cross_90': 'strong_cross',
}  # fmt: skip
MISSION: Final = 'greenhouse_summer'
RING_SIZE: Final = 8
BEYOND_HEIGHT: Final = 0.5  # m
BEYOND_BAR_CAPTION: Final = (
    'Path, time and success with 95 % intervals. Stars: flights printed in the paper.'
)
BEYOND_TRACK_CAPTION: Final = (
    'Ground tracks from above in a uniform headwind of 0.57 m/s, both with the same seed.'
)
DAY_CAPTION: Final = (
    'Charge over a midsummer day in a greenhouse under the same clouds: the light-aware '
    'schedule (by light), '
    "which uses a forecast, and the paper's fixed duty cycle. Top: the light."
)


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Study wind, missions, beacons and bearings, each against the paper's method."""
    # --quick flies homing only.
    strategies = BEYOND_STRATEGIES[1:] if request.quick else BEYOND_STRATEGIES
    indoors = fly_group('indoors', request.seeds, strategies=strategies)
    values: dict[str, MeasuredValue] = {}
    for name in strategies:
        values |= summarize_cell(name, indoors.find_cell(name))
    pictures = [
        StudyPicture('strategies', 'BAG and homing, indoors', BEYOND_BAR_CAPTION,
                     plot_paper_comparison(list(indoors.cells)),
                     format_lta_command('light', 'evaluate', '--sets', 'indoors',
                                        '--seeds', str(request.seeds)))
    ]  # fmt: skip
    if request.quick:
        return RowStudyResult(values, pictures)
    winds = fly_group(
        'uniform', request.seeds, strategies=BEYOND_STRATEGIES, cases=list(BEYOND_WINDS)
    )
    for case, label in BEYOND_WINDS.items():
        values |= {
            f'{name}_{label}_reached': measure_success_share(winds.find_cell(name, case))
            for name in BEYOND_STRATEGIES
        }
    values |= measure_bearings(request.seeds)
    missions, day = study_mission(request.folder / MISSION, request.seeds)
    pictures += [build_headwind_picture(winds), day]
    return RowStudyResult({**values, **missions}, pictures)


def measure_bearings(seeds: int) -> dict[str, MeasuredValue]:
    """Return the error of both bearing estimators in the worst direction, indoors. [rad]"""
    bench = BearingBench(build_flight_spec(BEARING_PLACES['indoor'], 'gtmab', RING_SIZE))
    rings: list[RingStudy] = [
        study_ring(bench, 'indoor', RING_SIZE, READINGS_PER_DIRECTION, seed)
        for seed in range(1, seeds + 1)
    ]
    return {
        'bearing_paper': average_over_seeds([max(ring.paper) for ring in rings]),
        'bearing_ours': average_over_seeds([max(ring.ours) for ring in rings]),
    }


def build_headwind_picture(winds: FlightGroup) -> StudyPicture:
    """Plot both strategies in a headwind, from above."""
    cells = list(winds.find_cells('head_90').values())
    seed = select_track_seed(cells)
    tracks, scenario = fly_again(winds.plan, cells, seed)
    again = format_command(winds, winds.find_cell('homing', 'head_90'), seed)
    above = thin_annotations(plot_tracks(tracks, scenario, BEYOND_HEIGHT))
    return StudyPicture('wind', 'In uniform wind', BEYOND_TRACK_CAPTION, above, again)


def study_mission(folder: Path, seeds: int) -> tuple[dict[str, MeasuredValue], StudyPicture]:
    """Simulate days in a greenhouse: gain of the light-aware schedule, and beacons visited."""
    # One day per seed; each seed draws its own clouds.
    order = load_request(MISSION, 1, range(1, seeds + 1), (AWARE, NAIVE))
    # In this process, as the rows already run in parallel.
    run = StudyRun(Console(quiet=True), folder, options=StudyOptions(workers=1))
    results = run_missions(order, run)
    ours = [each.figures for each in filter_by_schedule(results, AWARE)]
    more = flight_time_ratio(results)
    # Both schedules were simulated, so the ratio exists.
    assert more is not None
    values = {
        'mission_gain': MeasuredValue(more.value, more.low, more.high, more.flights),
        'mission_flown': average_over_seeds([each.flown for each in ours]),
        'mission_beacons': average_over_seeds([each.visits / each.flights for each in ours]),
        'mission_rounds': average_over_seeds([each.rounds / each.flights for each in ours]),
        'mission_failed': MeasuredValue(
            float(sum(each.failure_count for each in ours)), seeds=seeds
        ),
    }
    first = [each for each in results if each.seed == order.seeds[0]]
    figure = draw_charge(first, order.simulate_light(order.seeds[0]), order.mission.reserve.si)
    return values, StudyPicture(
        'day', 'A day with the light-aware schedule', DAY_CAPTION, figure,
        format_lta_command('mission', MISSION, '--seeds', str(seeds)),
    )  # fmt: skip
