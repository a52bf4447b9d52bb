"""
Keep a fit from predicting its own flights worse than the vehicle file does.

A latent wrench helps a fit to follow its flights; forecasts show whether the values themselves are
better. Where they are not, the tolerances are scaled down, to none if need be, and named effects
that make forecasts worse are withdrawn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final, Literal

from lta_discovery.finding import ChannelErrors
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.forecast.held_out import build_model_points, compute_model_errors, WHOLE
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.replay.flight_linearizer import FlightLinearizer
import numpy as np

Model = Literal['tuned', 'after']

WORSE: Final = 1.05  # of the error of the vehicle file; above it a fit is worse
AHEAD: Final = 3.0  # s; longest compared horizon
SHARES: Final = (0.5, 0.25, 0.1, 0.03, 0.0)  # of the fitted tolerances, tried in turn


@final
@dataclass(frozen=True, slots=True)
class ComparedFits:
    """Fits that predict their own flights no worse than the vehicle file."""

    # Without effects, and with those named
    bare: JointFit
    full: JointFit
    errors: tuple[ChannelErrors, ...]  # of position and attitude on the flights of the fit
    share: float = 1.0  # of the fitted tolerances that is kept
    # Whether the named effects made forecasts worse: `full` is `bare` then
    withdrawn: bool = False


def limit_to_file(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    bare: JointFit,
    full: JointFit,
    named: Sequence[int] = (),
    seed: int = 0,
) -> ComparedFits:
    """
    Return fits that predict their flights no worse than the vehicle file.

    `flights`: of the fits, which are compared on them. `named`: indices of the parameters of named
    effects, which are not scaled.
    """

    def compare(tuned: JointFit, after: JointFit) -> tuple[ChannelErrors, ...]:
        models = [build_model_points(flight, nominal, tuned, after) for flight in flights]
        return tuple(compute_model_errors(flights, models, seed, tuple(WHOLE)))

    errors, share, fitted = compare(bare, full), 1.0, bare
    alone = full is bare
    for part in SHARES:
        if not is_worse_than_file(errors, 'tuned'):
            break
        share, bare = part, _scale_tolerances(fitted, part, ())
        errors = compare(bare, bare if alone else full)
    if alone or not is_worse_than_file(errors, 'after'):
        return ComparedFits(bare, bare if alone else full, errors, share)
    for part in SHARES:
        scaled = _scale_tolerances(full, part, named)
        errors = compare(bare, scaled)
        if not is_worse_than_file(errors, 'after'):
            return ComparedFits(bare, scaled, errors, share)
    return ComparedFits(bare, bare, compare(bare, bare), share, withdrawn=True)


def is_worse_than_file(errors: Sequence[ChannelErrors], model: Model) -> bool:
    """Return whether position or attitude is predicted worse than with the vehicle file."""
    for channel in WHOLE:
        near = [one for one in errors if one.channel == channel and one.horizon_s <= AHEAD]
        if not near:
            continue
        last = max(near, key=lambda one: one.horizon_s)
        error = float(getattr(last, model))
        if error > WORSE * last.before and not math.isinf(last.before):
            return True
    return False


def _scale_tolerances(fit: JointFit, share: float, named: Sequence[int]) -> JointFit:
    """Return a fit with a share of its values, except for those of named effects."""
    mean = share * fit.fitted.mean
    indices = list(named)
    mean[indices] = fit.fitted.mean[indices]
    return replace(fit, fitted=fit.fitted._replace(mean=np.asarray(mean)))


def format_share_warning(share: float) -> str:
    """Return a warning that only a share of the fitted tolerances is used."""
    if share == 0.0:
        return (
            'No fit within the tolerances of the vehicle file predicts its own flights as well as '
            'the file itself, so the tuned model is the file: its values are further off than '
            'their tolerances, or something else is missing.'
        )
    return (
        f'The fitted tolerances predict their own flights worse than the vehicle file, so only '
        f'{100.0 * share:.0f} % of each is used.'
    )


def format_withdrawal(names: Sequence[str]) -> str:
    """Return a warning that names are withdrawn because they make forecasts worse."""
    return (
        f'{", ".join(names)}: not reported, because with it the flights of the fit are predicted '
        'worse than with the vehicle file.'
    )
