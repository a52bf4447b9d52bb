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
    Return the wrench per unit of each linear parameter.

    Parameters
    ----------
    effect : WrenchEffect
        The effect.
    values : mapping
        The parameters in which it is not linear; those left out are at their null value.
    motion : Motion
        State of the vehicle.
    thrust : tuple of float
        Thrust of each rotor. [N]
    memory : tuple of float
        Memory of the effect.

    Returns
    -------
    ndarray, shape (6, len(effect.linear_in))
        Columns in the order of `effect.linear_in`. [N, N m per unit of the parameter]

    """
    names = [parameter.name for parameter in effect.parameters]
    held = [values.get(parameter.name, parameter.null) for parameter in effect.parameters]
    places = [names.index(name) for name in effect.linear_in]
    columns = np.empty((6, len(places)))
    for column, place in enumerate(places):
        unit = list(held)
        for other in places:
            unit[other] = float(other == place)
        columns[:, column] = effect.wrench(tuple(unit), memory, motion, thrust)
    return columns
