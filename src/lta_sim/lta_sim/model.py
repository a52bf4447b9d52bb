"""A vehicle as the numbers that the kernel takes."""

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import final, Self

from lta_config.errors import BadInput
from lta_sim import effects
from lta_sim.effects.protocol import Effect, InertiaEffect
from lta_sim.mass import rigid_mass_matrix
import numpy as np
from numpy.typing import ArrayLike, NDArray

Vector = NDArray[np.float64]


def _values(effect: Effect, given: Mapping[str, float]) -> dict[str, float]:
    """Return all parameters of an effect, those not given at their null value."""
    values = {parameter.name: parameter.null for parameter in effect.parameters}
    for name, value in given.items():
        if name not in values:
            raise BadInput(
                f'The effect {effect.name} has no parameter {name!r}; it has {", ".join(values)}.'
            )
        values[name] = float(value)
    for known in effect.parameters:
        value = values[known.name]
        if value != known.null and not known.low <= value <= known.high:
            raise BadInput(
                f'{effect.name}.{known.name} is {value:g} {known.unit}; '
                f'give a value from {known.low:g} to {known.high:g}.'
            )
    if objection := effect.check(values):
        raise BadInput(f'{effect.name}: {objection}.')
    return values


def _symmetric(inertia: ArrayLike) -> Vector:
    """Return a 3 x 3 inertia from itself or from ixx ixy ixz iyy iyz izz."""
    tensor = np.asarray(inertia, dtype=np.float64)
    if tensor.shape == (6,):
        xx, xy, xz, yy, yz, zz = tensor
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if tensor.shape != (3, 3) or not np.array_equal(tensor, tensor.T):
        raise BadInput(
            f'The inertia has shape {tensor.shape}; give a symmetric 3 x 3 tensor or its six '
            'elements ixx ixy ixz iyy iyz izz.'
        )
    if not (np.isfinite(tensor).all() and np.linalg.eigvalsh(tensor)[0] > 0.0):
        raise BadInput(f'The inertia {tensor.tolist()} is not positive definite; correct it.')
    return tensor


@final
@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """
    A vehicle as the numbers that the kernel takes; build it with `Model.build`.

    Parameters
    ----------
    parameters : ndarray, shape (P,)
        Parameters of all effects in registry order.
    body : ndarray, shape (16,)
        m, m r (3), inertia about the hull centre (xx yy zz xy xz yz), added mass (6), SI.
    inverse : ndarray, shape (36,)
        Inverse of the mass matrix, rigid and added, row by row.

    """

    parameters: Vector
    body: Vector
    inverse: Vector

    @classmethod
    def build(
        cls,
        given: Mapping[str, Mapping[str, float]],
        *,
        mass: float,
        cg: ArrayLike,
        inertia: ArrayLike,
    ) -> Self:
        """
        Return the model of a vehicle.

        Parameters
        ----------
        given : mapping
            Parameters by effect and name; whatever is left out is at its null value.
        mass : float
            Mass of the solid parts and of the gas. [kg]
        cg : array_like, shape (3,)
            Centre of gravity from the hull centre, body frame. [m]
        inertia : array_like, shape (3, 3) or (6,)
            About the centre of gravity; six elements are ixx ixy ixz iyy iyz izz, those of the
            tensor, as in geometry_msgs/Inertia. [kg m^2]

        Raises
        ------
        BadInput
            For an unknown effect or parameter, a value out of bounds, or a mass or inertia that no
            body has.

        """
        if not (math.isfinite(mass) and mass > 0.0):
            raise BadInput(f'The mass is {mass:g} kg; give a positive number.')
        r = np.asarray(cg, dtype=np.float64)
        if r.shape != (3,) or not np.isfinite(r).all():
            raise BadInput(f'The centre of gravity is {r.tolist()}; give three finite numbers.')
        for name in given:
            effects.get(name)
        parameters: list[float] = []
        added = np.zeros(6)
        for name, effect in effects.EFFECTS.items():
            values = tuple(_values(effect, given.get(name, {})).values())
            parameters.extend(values)
            if isinstance(effect, InertiaEffect):
                added += effect.diagonal(values)
        rigid = rigid_mass_matrix(mass, r, _symmetric(inertia))
        i = rigid[3:, 3:]
        moments = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
        return cls(
            np.array(parameters),
            np.array([mass, *(mass * r), *moments, *added]),
            np.linalg.inv(rigid + np.diag(added)).ravel().astype(np.float64),
        )
