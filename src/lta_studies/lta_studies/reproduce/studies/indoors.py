"""Compare the strategies in simulation and indoors: success, path and time."""

from collections.abc import Mapping
from itertools import pairwise
import math
from typing import Final

from lta_config.command_line import format_lta_command
from lta_studies.light.evaluation.cells import EvaluationCell
from lta_studies.light.evaluation.paper import ORDER
from lta_studies.light.evaluation.path_order import assess_path_order
from lta_studies.light.evaluation.pictures import plot_paper_comparison
from lta_studies.light.evaluation.tracks import fly_again, plot_tracks, select_track_seed
from lta_studies.reproduce.flights import (
    FlightGroup,
    fly_group,
    format_command,
    PAPERS,
    record_group,
    summarize_cell,
)
from lta_studies.reproduce.study_result import (
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)

SAFE: Final = {'scenario.goal.radius': '2 m'}  # the paper's simulation
FAST: Final = {'mission.speed': 0.87}  # m/s, the paper's path divided by its time
TOWARDS: Final = 'start_heading'
HEADINGS: Final = {  # name and heading of the top views, by prefix of the measures
    '': ('indoors', 'Indoors: reach the lamp within 1 m, any start heading'),
    'sim_': ('simulation', "Reach the lamp within 2 m, as in the paper's simulation"),
    f'{TOWARDS}_': ('towards', 'Indoors: start heading within 30° of the lamp'),
}
FACTORS: Final = {
    'not_stopping': ('dga',),
    'no_computing': ('dga',),
    'plane_through_origin': ('dga',),
    'gradient_alone': ('des',),
    'narrow_diodes': ('dga', 'des'),
}
PRINTED: Final = {  # m and s, seed paper
    'bag_path': 7.3, 'dga_path': 8.6, 'des_path': 12.2, 'bag_time': 8.4, 'dga_time': 21.4,
}  # fmt: skip
CALLED: Final = {
    'towards': 'a start within 30° of the lamp', 'fast': 'BAG at 0.87 m/s',
    'not_stopping': 'DGA that does not stop', 'no_computing': 'DGA that computes in no time',
    'plane_through_origin': 'a plane through the origin',
    'gradient_alone': 'DES by the gradient alone', 'narrow_diodes': 'diodes that look ahead only',
}  # fmt: skip
TRACKS: Final = (
    'Ground tracks from above with the same seed; the yellow fan is the light of the lamp.'
)
BARS: Final = (
    'Path, time and success of each strategy with 95 % intervals. Stars: flights printed in the '
    'paper.'
)


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Fly as in the paper, and with one factor changed at a time."""
    groups = {'': fly_group('indoors', request.seeds)}
    if not request.quick:
        groups['sim_'] = fly_group('indoors', request.seeds, change=SAFE)
        groups[f'{TOWARDS}_'] = fly_group('ablations', request.seeds, cases=[TOWARDS])
    values: dict[str, MeasuredValue] = {}
    for prefix, group in groups.items():
        values |= rank_strategies(prefix, group.find_cells())
        for name in PAPERS:
            values |= summarize_cell(f'{prefix}{name}', group.find_cell(name))
    if not request.quick:
        fast = fly_group('indoors', request.seeds, strategies=('bag',), change=FAST)
        values |= summarize_cell('fast_bag', fast.find_cell('bag'))
        values |= measure_factors(request.seeds)
        values |= compute_misfits(values)
    indoors = groups['']
    values['dga_by_bag_time'] = mean_ratio(indoors, 'search_time', 'dga', 'bag')
    values['dga_by_bag_path'] = mean_ratio(indoors, 'path_length', 'dga', 'bag')
    return RowStudyResult(values, plot_indoor_flights(request, groups))


def measure_factors(seeds: int) -> dict[str, MeasuredValue]:
    """Fly with one factor changed at a time."""
    values: dict[str, MeasuredValue] = {}
    for case, strategies in FACTORS.items():
        found = fly_group('ablations', seeds, strategies=strategies, cases=[case])
        for name in strategies:
            values |= summarize_cell(f'{case}_{name}', found.find_cell(name))
    return values


def compute_misfits(values: Mapping[str, MeasuredValue]) -> dict[str, MeasuredValue]:
    """Return the misfit to the printed paths and times as flown, and with the best factor."""
    flown = {'as_flown': '', 'towards': f'{TOWARDS}_', 'fast': 'fast_'}
    flown |= {case: f'{case}_' for case in FACTORS}
    off = {case: rms_misfit(values, prefix) for case, prefix in flown.items()}
    best = min((case for case in off if case != 'as_flown'), key=off.__getitem__)
    return {
        'misfit_as_flown': MeasuredValue(off['as_flown']),
        'misfit_best': MeasuredValue(off[best]),
        'misfit_cause': MeasuredValue(CALLED[best]),
    }


def rms_misfit(values: Mapping[str, MeasuredValue], prefix: str) -> float:
    """Return exp(rms of log(ours / printed)) - 1 over the printed numbers. [1]"""
    logs = []
    for name, printed in PRINTED.items():
        # A factor that changes one strategy leaves the others as flown.
        value = values.get(f'{prefix}{name}', values[name]).value
        assert not isinstance(value, str)
        # Logarithms weigh twice and half the printed value equally, whatever the unit.
        logs.append(math.log(value / printed))
    return math.exp(math.sqrt(math.fsum(each * each for each in logs) / len(logs))) - 1.0


def rank_strategies(prefix: str, cells: Mapping[str, EvaluationCell]) -> dict[str, MeasuredValue]:
    """Rank the strategies by path; add the bootstrap share that keeps the paper's order."""
    held = assess_path_order('', {name: cells[name] for name in ORDER})
    paths = sorted(ORDER, key=lambda name: held.paths[name].value)
    # Unknown if any mean path is NaN because no flight arrived.
    known = all(a == a for a, _ in pairwise([held.paths[name].value for name in (*paths, 'bag')]))
    return {
        f'{prefix}order': MeasuredValue(
            ' < '.join(name.upper() for name in paths) if known else 'none'
        ),
        f'{prefix}order_draws': MeasuredValue(held.share, seeds=len(cells['bag'].rows)),
    }


def mean_ratio(group: FlightGroup, figure: str, above: str, below: str) -> MeasuredValue:
    """Return the ratio of the means of two strategies."""
    top, bottom = (group.find_cell(name).mean(figure) for name in (above, below))
    value = top.value / bottom.value if bottom.value else math.nan
    return MeasuredValue(value, seeds=top.flights)


def plot_indoor_flights(
    request: RowStudyRequest, groups: Mapping[str, FlightGroup]
) -> list[StudyPicture]:
    """Plot the flights from above, and the comparison with the paper."""
    indoors = groups['']
    made = [
        StudyPicture('bars', 'Indoors, compared with the paper', BARS,
                     plot_paper_comparison(list(indoors.cells)),
                     format_lta_command('light', 'evaluate', '--sets', 'indoors',
                                        '--seeds', str(request.seeds)))
    ]  # fmt: skip
    for prefix, group in groups.items():
        name, heading = HEADINGS[prefix]
        cells = group.cells
        seed = select_track_seed(cells)
        tracks, scenario = fly_again(group.plan, cells, seed)
        bag = '' if request.quick else record_group(group, cells, seed, request.folder / name)
        first = next(each for each in cells if each.strategy == 'bag')
        again = format_command(group, first, seed)
        made.append(
            StudyPicture(name, heading, TRACKS, plot_tracks(tracks, scenario, 0.5), again, bag)
        )
    return made
