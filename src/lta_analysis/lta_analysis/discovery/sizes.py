"""
How large what was named is, and how well that is known.

The flights' own interval takes the model for exact and its pieces for independent. Neither is
quite so: an integrator, a command that takes over within a few milliseconds, a sensor's filter are
off by what no flight of the same vehicle can show. By how much (`WIDER`, `PART`) was found on
hidden truths.
"""

from collections.abc import Sequence
from typing import Final

from lta_analysis.discovery.finding import Learned, NamedEffect
from lta_analysis.discovery.fit import turned
from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.nominal import Nominal
from lta_analysis.discovery.proof import Proven
from lta_sim.effects import EFFECTS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NORMAL: Final = 1.96  # deviations, of the 95 % interval
WIDER: Final = 1.3  # factor on the deviations
PART: Final = 0.01  # of the value, that it is off by at least


def learned(nominal: Nominal, proven: Proven, known: Sequence[Knob]) -> Nominal:
    """Return the vehicle file's vehicle with the named effects, and nothing else changed."""
    values = np.where([knob.name in proven.names for knob in known], _values(proven, known), 0.0)
    return turned(nominal, known, values)[0]


def _values(proven: Proven, known: Sequence[Knob]) -> Array:
    """Return the most probable knobs that flights share, within their bounds."""
    mean = proven.measured.fitted.mean[: len(known)]
    inside: Array = np.clip(mean, [knob.low for knob in known], [knob.high for knob in known])
    return inside


def _spread(proven: Proven) -> Array:
    """Return their standard deviations, with what the model itself may be off by."""
    found = proven.measured.fitted
    spread: Array = np.sqrt((WIDER**2) * np.diag(found.covariance) + (PART * found.mean) ** 2)
    return spread


def effects(nominal: Nominal, proven: Proven, known: Sequence[Knob]) -> tuple[NamedEffect, ...]:
    """Return the effects that were found missing, the strongest first."""
    values, spread = _values(proven, known), _spread(proven)
    by_effect: dict[str, list[int]] = {}
    for name in proven.names:
        k = next(i for i, knob in enumerate(known) if knob.name == name)
        by_effect.setdefault(name.partition('.')[0], []).append(k)
    out = []
    for effect, places in by_effect.items():
        names = tuple(known[k].name for k in places)
        parameters = tuple(
            each
            for k in places
            for each in _parameters(nominal, known[k], effect, float(values[k]), float(spread[k]))
        )
        cost = max(proven.costs[name] for name in names)
        rivals = dict.fromkeys(rival for name in names for rival in proven.rivals[name])
        out.append(NamedEffect(effect, names, parameters, cost, tuple(rivals)))
    return tuple(out)


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
        out.append(Learned(parameter, units[parameter], before, now, (now - half, now + half)))
    return out
