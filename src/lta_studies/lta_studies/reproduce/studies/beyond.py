"""What the paper leaves for later, and our estimator and strategy beside its own."""

from pathlib import Path
from typing import Final

from lta_config.typed import typed
from lta_studies.light.bearing.bench import Bench
from lta_studies.light.bearing.places import made_of, PLACES
from lta_studies.light.bearing.study import one_ring, READINGS, Studied
from lta_studies.light.evaluation.pictures import beside_paper
from lta_studies.light.evaluation.tracks import fly_again, picture, shown_seed
from lta_studies.mission.lived import AWARE, NAIVE
from lta_studies.mission.pictures import day_picture
from lta_studies.mission.run import gain, of, order_of, run
from lta_studies.reproduce.flights import command, figures, fly, Group, record, share_of, uncrowded
from lta_studies.reproduce.found import Asked, Found, over, Picture, Value

BOTH: Final = ('bag', 'homing')
WINDS: Final = {  # of the sweep: mean plus one deviation 60 and 90 % of the top airspeed
    'head_60': 'head', 'head_90': 'strong_head', 'cross_60': 'cross', 'cross_90': 'strong_cross',
}  # fmt: skip
MISSION: Final = 'greenhouse_summer'
DIODES: Final = 8
HEIGHT: Final = 0.5  # m
BARS: Final = (
    'Path, time and success, 95 % intervals; stars are the flights that the paper prints.'
)
TRACKS: Final = 'Ways over ground from above in a uniform headwind of 0.86 m/s, the same seed.'
DAY: Final = (
    'Charge over a day of midsummer in a greenhouse under the same clouds: by light, which looks '
    "at what is to come, and the paper's fixed duty cycle. Above, the light."
)


def study(asked: Asked) -> Found:
    """Return wind, missions, beacons and bearings; the paper's own way beside each."""
    flown = BOTH[1:] if asked.quick else BOTH
    indoors = fly('indoors', asked.seeds, strategies=flown)
    values: dict[str, Value] = {}
    for name in flown:
        values |= figures(name, indoors.of(name))
    pictures = [
        Picture('strategies', 'BAG and homing, indoors', BARS, beside_paper(list(indoors.cells)),
                typed('light', 'evaluate', '--sets', 'indoors', '--seeds', str(asked.seeds)))
    ]  # fmt: skip
    if asked.quick:
        return Found(values, pictures)
    winds = fly('uniform', asked.seeds, strategies=BOTH, cases=list(WINDS))
    for case, told in WINDS.items():
        values |= {f'{name}_{told}_reached': share_of(winds.of(name, case)) for name in BOTH}
    values |= bearings(asked.seeds)
    lived, drawn = mission(asked.folder / MISSION, asked.seeds)
    pictures += [windy(asked, winds), drawn]
    return Found({**values, **lived}, pictures)


def bearings(seeds: int) -> dict[str, Value]:
    """Return the worst direction by both estimators of the bearing, indoors. [rad]"""
    bench = Bench(made_of(PLACES['indoor'], 'gtmab', DIODES))
    rings: list[Studied] = [
        one_ring(bench, 'indoor', DIODES, READINGS, seed, lambda: None)
        for seed in range(1, seeds + 1)
    ]
    return {
        'bearing_paper': over([max(ring.paper) for ring in rings]),
        'bearing_ours': over([max(ring.ours) for ring in rings]),
    }


def windy(asked: Asked, winds: Group) -> Picture:
    """Return both strategies in a headwind, from above."""
    cells = list(winds.strategies('head_90').values())
    seed = shown_seed(cells)
    tracks, scenario = fly_again(winds.plan, cells, seed)
    bag = record(winds, cells, seed, asked.folder / 'wind')
    again = command(winds, winds.of('homing', 'head_90'), seed)
    above = uncrowded(picture(tracks, scenario, HEIGHT))
    return Picture('wind', 'In uniform wind', TRACKS, above, again, bag)


def mission(folder: Path, seeds: int) -> tuple[dict[str, Value], Picture]:
    """Return a day in a greenhouse: what looking at the light brings, and how many beacons."""
    order = order_of(MISSION, 1, range(1, seeds + 1), (AWARE, NAIVE))
    folder.mkdir(parents=True, exist_ok=True)
    lives = run(order, folder, lambda _: None)
    ours = [each.figures for each in of(lives, AWARE)]
    more = gain(lives)
    assert more is not None
    values = {
        'mission_gain': Value(more.value, more.low, more.high, more.flights),
        'mission_flown': over([each.flown for each in ours]),
        'mission_beacons': over([each.visits / each.flights for each in ours]),
        'mission_rounds': over([each.rounds / each.flights for each in ours]),
        'mission_failed': Value(float(sum(each.failed for each in ours)), seeds=seeds),
    }
    first = [each for each in lives if each.seed == order.seeds[0]]
    figure = day_picture(first, order.light(order.seeds[0]), order.mission.reserve.si)
    return values, Picture(
        'day', 'A day that looks at the light', DAY, figure,
        typed('mission', MISSION, '--seeds', str(seeds)),
    )  # fmt: skip
