"""Convert effects identified by forecasts to registry effects with intervals."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from lta_discovery.finding import NamedEffect, ParameterEstimate
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.effect_sizes import list_assumed_parameters
from lta_discovery.transfer.bootstrap_intervals import compute_confidence_intervals
from lta_discovery.transfer.candidate_groups import CandidateGroup, list_knobs
from lta_discovery.transfer.effect_values import EffectValues
from lta_discovery.transfer.forward_selection import CandidateGain, GroupSelection
from lta_model.effects import EFFECTS

NEAR: Final = 0.9  # of the gain of an effect; candidates with more in its round are its rivals


def build_named_effects(
    nominal: NominalVehicle,
    knobs: Sequence[FreeParameter],
    chosen: GroupSelection,
    confirmed: Sequence[CandidateGroup],
    best: EffectValues,
) -> tuple[NamedEffect, ...]:
    """Return the named effects of the registry, the strongest first."""
    bounds = dict(zip(best.which, compute_confidence_intervals(best.draws), strict=True))
    out: dict[str, NamedEffect] = {}
    for group in confirmed:
        place = chosen.groups.index(group)
        values, rivals = best.fitted.values, _list_close_rivals(group, chosen.rounds[place], knobs)
        # A value of 0 is clipped at its bound, and not part of the effect.
        moved = [k for k in group.knobs if values[k] != 0.0]
        effects = {k: knobs[k].name.partition('.')[0] for k in moved}
        for effect in dict.fromkeys(effects.values()):
            before = out.get(effect, NamedEffect(effect, (), (), 0.0))
            # A part of a hull may have been chosen before all of it
            own = [k for k in moved if effects[k] == effect and knobs[k].name not in before.knobs]
            parameters = [
                each
                for k in own
                for each in _estimate_parameters(nominal, knobs[k], float(values[k]), bounds[k])
            ]
            out[effect] = NamedEffect(
                effect,
                (*before.knobs, *(knobs[k].name for k in own)),
                (*before.parameters, *parameters),
                before.log_evidence + chosen.log_likelihood_gains[place],
                (*before.confusable_with, *rivals),
            )
    with_assumptions = [
        replace(one, assumed=list_assumed_parameters(nominal, one.name, one.parameters))
        for one in out.values()
    ]
    return tuple(sorted(with_assumptions, key=lambda one: -one.log_evidence))


def _list_close_rivals(
    group: CandidateGroup, tried: Sequence[CandidateGain], knobs: Sequence[FreeParameter]
) -> tuple[str, ...]:
    """Return the candidates with nearly the same gain in the round of an effect."""
    own = next(one.worth for one in tried if one.group == group)
    near = [one.group for one in tried if one.group != group and one.worth > NEAR * own]
    # A part of the effect is no rival of it
    return tuple(knobs[k].name for k in list_knobs(near) if k not in group.knobs)


def _estimate_parameters(
    nominal: NominalVehicle, knob: FreeParameter, value: float, interval: tuple[float, float]
) -> list[ParameterEstimate]:
    """Return the estimates of the effect parameters that a free parameter moves."""
    effect = knob.name.partition('.')[0]
    units = {declaration.name: declaration.unit for declaration in EFFECTS[effect].parameters}
    begun, out = knob.enable_effect(nominal), []
    for (moved, parameter), rate in knob.moves.items():
        if moved != effect:
            continue
        start = begun.parameter_value(effect, parameter)
        low, high = sorted(start + rate * end for end in interval)
        before = nominal.parameter_value(effect, parameter)
        now, there = start + rate * value, effect in nominal.effect_parameters
        out.append(ParameterEstimate(parameter, units[parameter], before, now, (low, high), there))
    return out
