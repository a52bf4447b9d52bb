"""
Estimate the sizes of named effects and their uncertainty.

The posterior assumes an exact model and white noise. It is widened by the scatter between pieces
(`robust_variance`) where that is larger, and by model errors that no flight of the same vehicle
can reveal (`interval`).
"""

from collections.abc import Sequence

from lta_discovery.finding import AssumedValue, NamedEffect, ParameterEstimate
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.evidence import ParameterPosterior
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.fit.robust_variance import sandwich_variance
from lta_discovery.model.candidates import companion_values
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.effect_verification import VerifiedEffects
from lta_discovery.selection.interval import NORMAL, parameter_deviations
from lta_model.effects import EFFECTS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def apply_named_effects(
    nominal: NominalVehicle,
    proven: VerifiedEffects,
    parameters: Sequence[FreeParameter],
    named: Sequence[NamedEffect],
) -> NominalVehicle:
    """Return the vehicle of the file with the named effects, and nothing else changed."""
    names = {name for one in named for name in one.knobs}
    values = np.where(
        [knob.name in names for knob in parameters],
        _clipped_posterior_mean(proven, parameters),
        0.0,
    )
    return apply_parameters(nominal, parameters, values)[0]


def _clipped_posterior_mean(proven: VerifiedEffects, parameters: Sequence[FreeParameter]) -> Array:
    """Return the posterior mean of the shared parameters, clipped to their bounds."""
    mean = proven.measured.fitted.mean[: len(parameters)]
    inside: Array = np.clip(
        mean, [knob.low for knob in parameters], [knob.high for knob in parameters]
    )
    return inside


def _widen_posterior(measured: JointFit) -> ParameterPosterior:
    """Return the posterior, with variances not below the scatter between pieces."""
    own = np.diag(measured.fitted.covariance)
    return measured.fitted._replace(
        # Only the variances are used later, so correlations are dropped
        covariance=np.diag(np.maximum(own, sandwich_variance(measured)))
    )


def build_effects(
    nominal: NominalVehicle,
    proven: VerifiedEffects,
    knobs: Sequence[FreeParameter],
    has_remainder: bool = False,
) -> tuple[NamedEffect, ...]:
    """Return the missing effects, the strongest first."""
    seen = _widen_posterior(proven.measured)
    values, deviations = (
        _clipped_posterior_mean(proven, knobs),
        parameter_deviations(seen, knobs, has_remainder),
    )
    by_effect: dict[str, list[str]] = {}
    for name in proven.names:
        # Names are 'effect.parameter'; report each effect once
        by_effect.setdefault(name.partition('.')[0], []).append(name)
    out, components = [], proven.select_components(knobs, np.sqrt(np.diag(seen.covariance)))
    for effect, own_names in by_effect.items():
        places = [k for name in own_names for k in components[name]]
        names = tuple(knobs[k].name for k in places)
        parameters = tuple(
            each
            for k in places
            for each in _estimate_parameters(
                nominal, knobs[k], effect, float(values[k]), float(deviations[k])
            )
        )
        # Parameters of one effect are removed one by one; the largest loss counts
        cost = max(proven.costs[name] for name in own_names)
        rivals = dict.fromkeys(rival for name in own_names for rival in proven.rivals[name])
        taken = list_assumed_parameters(nominal, effect, parameters)
        out.append(NamedEffect(effect, names, parameters, cost, tuple(rivals), taken))
    return tuple(out)


def list_assumed_parameters(
    nominal: NominalVehicle, effect: str, learned: Sequence[ParameterEstimate]
) -> tuple[AssumedValue, ...]:
    """Return the parameters of an effect that are neither in the vehicle file nor fitted."""
    if effect in nominal.effect_parameters:
        return ()
    units = {parameter.name: parameter.unit for parameter in EFFECTS[effect].parameters}
    fitted = {one.name for one in learned}
    return tuple(
        AssumedValue(name, units[name], value)
        for name, value in companion_values(effect).items()
        if name not in fitted and value != 0.0
    )


def _estimate_parameters(
    nominal: NominalVehicle, knob: FreeParameter, effect: str, value: float, spread: float
) -> list[ParameterEstimate]:
    """Return the estimates of the effect parameters that a free parameter moves."""
    units = {declaration.name: declaration.unit for declaration in EFFECTS[effect].parameters}
    begun, out = knob.enable_effect(nominal), []
    for (moved, parameter), rate in knob.moves.items():
        # Companions in other effects (such as cross flow) are not reported here
        if moved != effect:
            continue
        before = nominal.parameter_value(effect, parameter)
        now = begun.parameter_value(effect, parameter) + rate * value
        # Half width of the 95 % interval, in the unit of the model parameter
        half = NORMAL * abs(rate) * spread
        interval = now - half, now + half
        there = effect in nominal.effect_parameters
        out.append(ParameterEstimate(parameter, units[parameter], before, now, interval, there))
    return out
