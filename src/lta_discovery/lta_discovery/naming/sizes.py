"""
How large what was named is, and how well that is known.

The flights' own interval takes the model for exact and the noise for white. Neither is quite so.
What the pieces of the flights show of it counts where it is more (`piecewise`), and what no flight
of the same vehicle can show is added to it (`interval`).
"""

from collections.abc import Sequence

from lta_discovery.finding import Assumed, Learned, NamedEffect
from lta_discovery.fit.bounds import turned
from lta_discovery.fit.evidence import Fitted
from lta_discovery.fit.fit import Joint
from lta_discovery.fit.piecewise import variance
from lta_discovery.model.candidates import alongside
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.naming.interval import NORMAL, spread
from lta_discovery.naming.proof import Proven
from lta_model.effects import EFFECTS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def learned(
    nominal: Nominal, proven: Proven, known: Sequence[Knob], named: Sequence[NamedEffect]
) -> Nominal:
    """Return the vehicle file's vehicle with the named effects, and nothing else changed."""
    told = {name for one in named for name in one.knobs}
    values = np.where([knob.name in told for knob in known], _values(proven, known), 0.0)
    return turned(nominal, known, values)[0]


def _values(proven: Proven, known: Sequence[Knob]) -> Array:
    """Return the most probable knobs that flights share, within their bounds."""
    mean = proven.measured.fitted.mean[: len(known)]
    inside: Array = np.clip(mean, [knob.low for knob in known], [knob.high for knob in known])
    return inside


def _seen(measured: Joint) -> Fitted:
    """Return the knobs after the data, each known no better than the pieces agree about it."""
    own = np.diag(measured.fitted.covariance)
    return measured.fitted._replace(covariance=np.diag(np.maximum(own, variance(measured))))


def effects(
    nominal: Nominal, proven: Proven, known: Sequence[Knob], beside: bool = False
) -> tuple[NamedEffect, ...]:
    """Return the effects that were found missing, the strongest first; `beside` as in `spread`."""
    seen = _seen(proven.measured)
    values, deviations = _values(proven, known), spread(seen, known, beside)
    by_effect: dict[str, list[str]] = {}
    for name in proven.names:
        by_effect.setdefault(name.partition('.')[0], []).append(name)
    out, told = [], proven.told(known, np.sqrt(np.diag(seen.covariance)))
    for effect, found in by_effect.items():
        places = [k for name in found for k in told[name]]
        names = tuple(known[k].name for k in places)
        parameters = tuple(
            each
            for k in places
            for each in _parameters(
                nominal, known[k], effect, float(values[k]), float(deviations[k])
            )
        )
        cost = max(proven.costs[name] for name in found)
        rivals = dict.fromkeys(rival for name in found for rival in proven.rivals[name])
        taken = assumed_values(nominal, effect, parameters)
        out.append(NamedEffect(effect, names, parameters, cost, tuple(rivals), taken))
    return tuple(out)


def assumed_values(
    nominal: Nominal, effect: str, learned: Sequence[Learned]
) -> tuple[Assumed, ...]:
    """Return the numbers of an effect that the vehicle file lacks and no flight was asked for."""
    if effect in nominal.given:
        return ()
    units = {known.name: known.unit for known in EFFECTS[effect].parameters}
    fitted = {one.name for one in learned}
    return tuple(
        Assumed(name, units[name], value)
        for name, value in alongside(effect).items()
        if name not in fitted and value != 0.0
    )


def _parameters(
    nominal: Nominal, knob: Knob, effect: str, value: float, spread: float
) -> list[Learned]:
    """Return the parameters of an effect that a knob moves."""
    units = {known.name: known.unit for known in EFFECTS[effect].parameters}
    begun, out = knob.ready(nominal), []
    for (moved, parameter), rate in knob.moves.items():
        if moved != effect:
            continue
        before = nominal.value(effect, parameter)
        now = begun.value(effect, parameter) + rate * value
        half = NORMAL * abs(rate) * spread
        interval = now - half, now + half
        there = effect in nominal.given
        out.append(Learned(parameter, units[parameter], before, now, interval, there))
    return out
