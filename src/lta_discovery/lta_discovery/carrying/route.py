"""
Names by forecasts, where the readings gave none: real flights of a model that is far from exact.

A likelihood over every reading is right where what the model misses is small. Where it is many
times the noise, or a filter ate the noise, a few seconds of forecast are what is left to judge by;
and what is named by them has to hold in regimes that were left out of the fit, and between the
flights that teach and those that confirm, both ways. A name that does not is said to interpolate.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final, final, NamedTuple

from lta_discovery.carrying.choose import choose, Chosen
from lta_discovery.carrying.confirm import confirmed
from lta_discovery.carrying.gaps import gaps
from lta_discovery.carrying.groups import Group, groups
from lta_discovery.carrying.named import effects
from lta_discovery.carrying.pieces import apart_for, far
from lta_discovery.carrying.refit import refitted
from lta_discovery.carrying.regimes import regimes
from lta_discovery.carrying.transfer import left, Regime, squared, TOLD
from lta_discovery.carrying.values import tuned, Valued, valued
from lta_discovery.finding import Carried, LeftOut, Worth
from lta_discovery.fit.bounds import turned
from lta_discovery.forecast.foresight import Foresight
from lta_discovery.replay.linear import Point, SENSORS, still
from lta_discovery.replay.linearise import Linearised
from lta_discovery.study import Flown, Shown, Study
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Progress = Callable[[str, float | None], None]

FEWEST: Final = 4  # flights that teach or confirm, where a filter ate the noise
LARGE: Final = 10.0  # floors; what remains where readings are not to be asked
ENOUGH: Final = 8  # the same, where it did not: readings have been asked already
LIFT: Final = 0.0025  # of the weight, that a flight's lift may be off by (as between RGBlimp's)
TUNED: Final = 0.97  # of the squared error that tuning tolerances leaves, in regimes left out
LOOSE: Final = 0.8  # of the squared error; what tolerances take more of, they explain
BESIDE: Final = 0.95  # the same, where tolerances are tuned beside the names
ATTEMPTS: Final = 4  # to name, each without what fell before
GRAVITY: Final = 9.81  # m/s2
POSE: Final = 6  # of CHANNELS, the first


@final
class Side(NamedTuple):
    """Flights that can be predicted far enough, each as flown and in overlapping pieces."""

    flown: list[Flown]
    sight: Foresight


@final
class Names(NamedTuple):
    """What was chosen last, what of it stands with its values, and what fell on the way."""

    chosen: Chosen
    kept: Sequence[Group]
    best: Valued | None
    lost: Sequence[Group]


def due(found: Study) -> bool:
    """Tell whether forecasts are to be asked: poses alone, and something without a name."""
    finding = found.finding
    if finding.verdict not in ('unexplained', 'named+unexplained', 'not_identifiable'):
        return False
    told = [one.flight.replay.flight for one in found.flights if one.role != 'holdout']
    if any(np.isfinite(flight.noise[POSE:]).any() for flight in told):
        return False
    smooth = all(flight.alike > 1.0 for flight in told)
    if smooth:
        return len(told) >= FEWEST
    large = any(one.floors >= LARGE for one in finding.remains)
    return large and not finding.effects and len(told) >= ENOUGH


def by_forecasts(found: Study, tell: Progress) -> Study:
    """
    Return a study with the names that forecasts give; as it was where they give none.

    Parameters
    ----------
    found : Study
        By the readings.
    tell : callable
        Told what is being done.

    """
    if not due(found):
        return found
    tell('asking forecasts', 0.0)
    taught = _side(found, [one for one in found.flights if one.role != 'holdout'])
    if taught is None or len(taught.flown) < FEWEST:
        return found
    parts = _parts(taught)
    plain, rest = tuned(taught.sight, parts)
    if left(rest) < LOOSE:
        return _warned(found, within_tolerances(left(rest)))
    names = _standing(taught, parts, rest, found.finding.seed, tell)
    if names.best is None:
        return _unnamed(found, names.lost)
    models = {'before': np.zeros_like(plain), 'tuned': plain, 'after': names.best.fitted.values}
    numbers = 0
    if len(taught.flown) >= ENOUGH:
        tell('refitting everything', 0.9)
        models['refitted'], numbers = refitted(taught.sight, names.best.fitted.values)
    told = _told(names.chosen, names.kept, names.best, [one.name for one in names.lost], numbers)
    return _shown_with(_named(found, taught, names, names.best, told), taught, models)


def _standing(
    taught: Side,
    parts: Mapping[str, Sequence[int]],
    rest: Sequence[Regime],
    seed: int,
    tell: Progress,
) -> Names:
    """Return the names that stand; one that falls makes room for others, a few times."""
    candidates, lost = groups(taught.sight.knobs), []
    halves = [
        [f for f, one in enumerate(taught.flown) if one.role == role]
        for role in ('train', 'confirm')
    ]
    every = range(len(taught.flown))
    for attempt in range(ATTEMPTS):
        tell('asking forecasts', attempt / ATTEMPTS)
        chosen = choose(taught.sight, every, parts, candidates)
        both = confirmed(taught.sight, chosen, halves)
        best, kept = _carrying(taught.sight, both, parts, seed, rest)
        fell = [one for one in chosen.groups if one not in kept]
        lost += fell
        if not fell:
            break
        candidates = [one for one in candidates if one not in fell]
    return Names(chosen, kept, best, lost)


def _told(
    chosen: Chosen, kept: Sequence[Group], best: Valued, lost: Sequence[str], numbers: int
) -> Carried:
    """Return what names rest on."""
    worth = {group.name: share for group, share in zip(chosen.groups, chosen.worth, strict=True)}
    return Carried(
        tuple(Worth(one.name, worth[one.name]) for one in kept),
        tuple(LeftOut(one.name, one.flights, one.ratio) for one in best.regimes),
        tuple(lost),
        numbers,
    )


def _side(found: Study, flown: Sequence[Flown]) -> Side | None:
    """Return some flights in pieces that are predicted; None where there are none."""
    knobs = flown[0].flight.knobs if flown else []
    apart = apart_for([one.flight.replay.flight for one in flown])
    cut = [(one, far(one.flight, knobs, apart)) for one in flown]
    known = [(one, flight) for one, flight in cut if flight is not None]
    if not known:
        return None
    lift = LIFT * GRAVITY * found.nominal.mass
    flights: list[Linearised] = [flight for _, flight in known]
    return Side([one for one, _ in known], Foresight(found.nominal, flights, lift))


def _parts(taught: Side) -> Mapping[str, Sequence[int]]:
    """Return the regimes of flights; where all are of one, every flight by itself."""
    parts = regimes(taught.sight.flights)
    if len(parts) > 1:
        return parts
    return {f'flight {one.name}': [f] for f, one in enumerate(taught.flown)}


def _carrying(
    sight: Foresight,
    groups: Sequence[Group],
    parts: Mapping[str, Sequence[int]],
    seed: int,
    rest: Sequence[Regime],
) -> tuple[Valued | None, Sequence[Group]]:
    """Return the most of some names that make every regime better, and more than tuning does."""
    while groups:
        best = valued(sight, groups, parts, seed)
        better = all(one.ratio < 1.0 for one in best.regimes)
        if better and squared(best.regimes) < TUNED * squared(rest):
            beside = tuned(sight, parts, groups)[1]
            if squared(beside) < BESIDE * squared(rest):
                return best, groups
        groups = groups[:-1]
    return None, groups


def _unnamed(found: Study, lost: Sequence[Group]) -> Study:
    """Return a study as it was, with what forecasts did not confirm."""
    return _warned(found, interpolating([one.name for one in lost])) if lost else found


def _warned(found: Study, sentence: str) -> Study:
    """Return a study with one more warning."""
    warnings = (*found.finding.warnings, sentence)
    return replace(found, finding=replace(found.finding, warnings=warnings))


def within_tolerances(share: float) -> str:
    """Return in words that tolerances leave only a share of the squared error."""
    taken = f'{100.0 * (1.0 - share):.0f} %'
    return (
        f'Forecasts name nothing: tolerances of the vehicle file alone take {taken} of the '
        'squared error in regimes left out, and no name can be told from them.'
    )


def interpolating(names: Sequence[str]) -> str:
    """Return in words that names did not carry over."""
    more = f' and {len(names) - TOLD} more' if len(names) > TOLD else ''
    return (
        f'{", ".join(names[:TOLD])}{more}: interpolation only; it makes forecasts better where it '
        'was fitted, and not for flights or regimes that were left out.'
    )


def _named(found: Study, taught: Side, names: Names, best: Valued, carried: Carried) -> Study:
    """Return a study with names."""
    knobs, warnings = taught.sight.knobs, found.finding.warnings
    if carried.interpolates:
        warnings = (*warnings, interpolating(carried.interpolates))
    finding = replace(
        found.finding,
        verdict='named+unexplained',
        effects=effects(found.nominal, knobs, names.chosen, names.kept, best),
        warnings=warnings,
        carried=carried,
    )
    learned = turned(found.nominal, knobs, best.fitted.values)[0]
    return replace(found, finding=finding, learned=learned)


def _shown_with(found: Study, taught: Side, models: Mapping[str, Array]) -> Study:
    """Return a study with the gap, on flights that nothing was fitted to where there are any."""
    last = _side(found, [one for one in found.flights if one.role == 'holdout'])
    shown = last or taught
    told = gaps(shown.sight, models, found.finding.seed)
    finding = replace(found.finding, gaps=tuple(told), held_out=last is not None)
    seen = [_shown(found, one, models) for one in shown.flown]
    every = models.get('refitted')
    whole = None if every is None else turned(found.nominal, taught.sight.knobs, every)[0]
    return replace(found, finding=finding, shown=seen, refitted=whole)


def _shown(found: Study, flown: Flown, models: Mapping[str, Array]) -> Shown:
    """Return a flight under each model."""
    flight = flown.flight
    none = still(flight.replay.cut)
    points = []
    for kind in ('before', 'tuned', 'after'):
        nominal, values = turned(found.nominal, flight.knobs, models[kind])
        points.append(Point(nominal, np.append(values, np.zeros(len(SENSORS))), none))
    return Shown(flown, *points)
