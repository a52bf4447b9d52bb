"""
Compute regressors for identification from the effect's own function.

A wrench linear in some parameters t is W = Phi t; column j of Phi is the wrench at t = e_j.
"""

from collections.abc import Mapping

from lta_model.effects.protocol import Values as Numbers
from lta_model.effects.protocol import VehicleMotion, WrenchEffect
import numpy as np
from numpy.typing import NDArray


def compute_regressors(
    effect: WrenchEffect,
    values: Mapping[str, float],
    motion: VehicleMotion,
    thrust: Numbers,
    memory: Numbers = (),
) -> NDArray[np.float64]:
    """
    Return the wrench per unit of each linear parameter, shape (6, len(effect.linear_in)).

    `values` are the parameters in which the effect is not linear (null if left out); `thrust` is
    in N.
    """
    names = [parameter.name for parameter in effect.parameters]
    held = [values.get(parameter.name, parameter.null) for parameter in effect.parameters]
    places = [names.index(name) for name in effect.linear_in]
    columns = np.empty((6, len(places)))
    for column, place in enumerate(places):
        unit = list(held)
        # Unit vector e_j in the linear parameters, the others held
        for other in places:
            unit[other] = float(other == place)
        columns[:, column] = effect.wrench(tuple(unit), memory, motion, thrust)
    return columns
