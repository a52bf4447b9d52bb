"""The strategies in simulation and indoors: who arrives, over which path and in what time."""

from collections.abc import Mapping
from itertools import pairwise
import math
from typing import Final

from lta_config.typed import typed
from lta_studies.light.evaluation.cells import Cell
from lta_studies.light.evaluation.order import found as order_found
from lta_studies.light.evaluation.paper import ORDER
from lta_studies.light.evaluation.pictures import beside_paper
from lta_studies.light.evaluation.tracks import fly_again, picture, shown_seed
from lta_studies.reproduce.flights import command, figures, fly, Group, PAPERS, record
from lta_studies.reproduce.found import Asked, Found, Picture, Value

SAFE: Final = {'scenario.goal.radius': '2 m'}  # the paper's simulation
FAST: Final = {'mission.speed': 0.87}  # m/s: what the paper's path and time make
TOWARDS: Final = 'start_heading'
HEADINGS: Final = {  # of the flights from above, by the prefix of their measures
    '': ('indoors', 'Indoors, to within 1 m, any heading'),
    'sim_': ('simulation', 'To within 2 m, as in simulation'),
    f'{TOWARDS}_': ('towards', 'Indoors, from a heading within 30° of the lamp'),
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
    'Ways over ground from above, the same seed for all; the yellow fan is the light of the lamp.'
)
BARS: Final = (
    'Path, time and success of each strategy with 95 % intervals; stars are the flights that the '
    'paper prints.'
)


def study(asked: Asked) -> Found:
    """Return flights as the paper's, and with one factor changed at a time."""
    groups = {'': fly('indoors', asked.seeds)}
    if not asked.quick:
        groups['sim_'] = fly('indoors', asked.seeds, change=SAFE)
        groups[f'{TOWARDS}_'] = fly('ablations', asked.seeds, cases=[TOWARDS])
    values: dict[str, Value] = {}
    for prefix, group in groups.items():
        values |= orders(prefix, group.strategies())
        for name in PAPERS:
            values |= figures(f'{prefix}{name}', group.of(name))
    if not asked.quick:
        fast = fly('indoors', asked.seeds, strategies=('bag',), change=FAST)
        values |= figures('fast_bag', fast.of('bag'))
        values |= factors(asked.seeds)
        values |= misfits(values)
    indoors = groups['']
    values['dga_by_bag_time'] = ratio(indoors, 'search_time', 'dga', 'bag')
    values['dga_by_bag_path'] = ratio(indoors, 'path_length', 'dga', 'bag')
    return Found(values, pictures(asked, groups))


def factors(seeds: int) -> dict[str, Value]:
    """Return the flights with one factor changed at a time."""
    values: dict[str, Value] = {}
    for case, strategies in FACTORS.items():
        found = fly('ablations', seeds, strategies=strategies, cases=[case])
        for name in strategies:
            values |= figures(f'{case}_{name}', found.of(name))
    return values


def misfits(found: Mapping[str, Value]) -> dict[str, Value]:
    """Return how far off the printed paths and times are, as flown and by each single factor."""
    flown = {'as_flown': '', 'towards': f'{TOWARDS}_', 'fast': 'fast_'}
    flown |= {case: f'{case}_' for case in FACTORS}
    off = {case: misfit(found, prefix) for case, prefix in flown.items()}
    best = min((case for case in off if case != 'as_flown'), key=off.__getitem__)
    return {
        'misfit_as_flown': Value(off['as_flown']),
        'misfit_best': Value(off[best]),
        'misfit_cause': Value(CALLED[best]),
    }


def misfit(found: Mapping[str, Value], prefix: str) -> float:
    """Return the rms of the logarithm of ours by the printed, as a factor less one. [1]"""
    logs = []
    for name, printed in PRINTED.items():
        value = found.get(f'{prefix}{name}', found[name]).value
        assert not isinstance(value, str)
        logs.append(math.log(value / printed))
    return math.exp(math.sqrt(math.fsum(each * each for each in logs) / len(logs))) - 1.0


def orders(prefix: str, cells: Mapping[str, Cell]) -> dict[str, Value]:
    """Return the strategies by path, and in how many resampled draws the paper's order holds."""
    held = order_found('', {name: cells[name] for name in ORDER})
    paths = sorted(ORDER, key=lambda name: held.paths[name].value)
    known = all(a == a for a, _ in pairwise([held.paths[name].value for name in (*paths, 'bag')]))
    return {
        f'{prefix}order': Value(' < '.join(name.upper() for name in paths) if known else 'none'),
        f'{prefix}order_draws': Value(held.share, seeds=len(cells['bag'].rows)),
    }


def ratio(group: Group, figure: str, above: str, below: str) -> Value:
    """Return the ratio of two strategies' means."""
    top, bottom = (group.of(name).mean(figure) for name in (above, below))
    value = top.value / bottom.value if bottom.value else math.nan
    return Value(value, seeds=top.flights)


def pictures(asked: Asked, groups: Mapping[str, Group]) -> list[Picture]:
    """Return the flights from above, and the bars of the paper."""
    indoors = groups['']
    made = [
        Picture('bars', 'Indoors, beside the paper', BARS,
                beside_paper(list(indoors.cells)),
                typed('light', 'evaluate', '--sets', 'indoors', '--seeds', str(asked.seeds)))
    ]  # fmt: skip
    for prefix, group in groups.items():
        name, heading = HEADINGS[prefix]
        cells = group.cells
        seed = shown_seed(cells)
        tracks, scenario = fly_again(group.plan, cells, seed)
        bag = '' if asked.quick else record(group, cells, seed, asked.folder / name)
        first = next(each for each in cells if each.strategy == 'bag')
        again = command(group, first, seed)
        made.append(Picture(name, heading, TRACKS, picture(tracks, scenario, 0.5), again, bag))
    return made
