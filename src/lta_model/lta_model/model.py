# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build the numerical model of a vehicle for the kernel.

Check that the time step is short enough for the explicit integrator.

Linear damping makes the velocity decay at the eigenvalues of M^-1 D, with M the mass matrix and D
the damping about the hull centre. RK4 is unstable where one of them times the step exceeds its
limit. Contact springs are far softer than that within their bounds. Damping that grows with the
speed is not checked here: the world watches for divergence during the flight.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import final, Self

from lta_config.errors import BadInput
from lta_model import effects
from lta_model.effects.protocol import (
    AXES,
    BodyEffect,
    Effect,
    InertiaEffect,
    KernelEffect,
    RigidBody,
)
from lta_model.mass_properties import rigid_mass_matrix, skew_matrix
from lta_model.state import ACTUATORS, ROTOR
import numpy as np
from numpy.typing import ArrayLike, NDArray

Vector = NDArray[np.float64]


def fill_parameters(effect: Effect, parameters: Mapping[str, float]) -> dict[str, float]:
    """
    Return all parameters of an effect, those not given at their null value.

    Raise `BadInput` for an unknown parameter, or a value out of bounds.
    """
    values = {parameter.name: parameter.null for parameter in effect.parameters}
    for name, value in parameters.items():
        if name not in values:
            raise BadInput(
                f'The effect {effect.name} has no parameter {name!r}; it has {", ".join(values)}.'
            )
        values[name] = float(value)
    for declaration in effect.parameters:
        value = values[declaration.name]
        # The null value is always allowed, even outside of the bounds
        if value != declaration.null and not declaration.low <= value <= declaration.high:
            raise BadInput(
                f'{effect.name}.{declaration.name} is {value:g} {declaration.unit}; '
                f'it must be from {declaration.low:g} to {declaration.high:g}.'
            )
    if objection := effect.check(values):
        raise BadInput(f'{effect.name}: {objection}.')
    return values


def _parse_inertia(inertia: ArrayLike) -> Vector:
    """Return a 3 x 3 inertia from itself or from ixx ixy ixz iyy iyz izz."""
    tensor = np.asarray(inertia, dtype=np.float64)
    if tensor.shape == (6,):
        # Order of geometry_msgs/Inertia
        xx, xy, xz, yy, yz, zz = tensor
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if tensor.shape != (3, 3) or not np.array_equal(tensor, tensor.T):
        raise BadInput(
            f'The inertia has the shape {tensor.shape}; give a symmetric 3 x 3 tensor or '
            'its six elements ixx ixy ixz iyy iyz izz.'
        )
    # A physical inertia has positive eigenvalues
    if not (np.isfinite(tensor).all() and np.linalg.eigvalsh(tensor)[0] > 0.0):
        raise BadInput(
            f'The inertia {tensor.tolist()} is not positive definite; correct its elements.'
        )
    return tensor


def _build_rigid_body(
    mass: float, cg: ArrayLike, inertia: ArrayLike, displaced: float
) -> RigidBody:
    """Return mass, balance and inertia about the hull centre."""
    if not (math.isfinite(mass) and mass > 0.0):
        raise BadInput(f'The mass is {mass:g} kg; it must be a positive number.')
    r = np.asarray(cg, dtype=np.float64)
    if r.shape != (3,) or not np.isfinite(r).all():
        raise BadInput(f'The centre of gravity is {r.tolist()}; give three finite numbers.')
    if not (math.isfinite(displaced) and displaced >= 0.0):
        raise BadInput(f'The mass of the displaced air is {displaced:g} kg; it must be 0 or more.')
    # Lower right block: inertia about the hull centre
    i = rigid_mass_matrix(mass, r, _parse_inertia(inertia))[3:, 3:]
    x, y, z = (mass * r).tolist()
    moments = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
    xx, yy, zz, xy, xz, yz = map(float, moments)
    return RigidBody(mass, (x, y, z), (xx, yy, zz, xy, xz, yz), displaced)


def _build_mass_matrix(rigid: RigidBody) -> Vector:
    """Return the mass matrix of a rigid body; raise `BadInput` for an impossible one."""
    lever = skew_matrix(np.array(rigid.moment))
    xx, yy, zz, xy, xz, yz = rigid.inertia
    about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    matrix = np.block([[rigid.mass * np.eye(3), -lever], [lever, about]])
    # Body effects, such as negative ballast, may make it impossible
    if not (rigid.mass > 0.0 and np.linalg.eigvalsh(matrix)[0] > 0.0):
        raise BadInput(
            f'With its effects, the vehicle has a mass of {rigid.mass:g} kg and an '
            'impossible inertia; reduce the effects that change mass or inertia, such as '
            'ballast.'
        )
    return matrix


def _pack_rotor_geometry(rotors: Sequence[tuple[ArrayLike, ArrayLike]]) -> Vector:
    """Return places and axes of the rotors, zeros for those that do not exist."""
    if len(rotors) > ACTUATORS:
        raise BadInput(
            f'The vehicle has {len(rotors)} rotors, but the model supports at most {ACTUATORS}; '
            'remove some.'
        )
    # Zero axis: a missing rotor exerts no force
    numbers = np.zeros((ACTUATORS, ROTOR))
    for row, (place, axis) in zip(numbers, rotors, strict=False):
        row[:3], row[3:] = place, axis
    return numbers.ravel()


@final
@dataclass(frozen=True, slots=True, eq=False)
class VehicleModel:
    """A vehicle as the arrays that the kernel takes; build it with `VehicleModel.build`."""

    parameters: Vector  # parameters of the kernel's effects in registry order, shape (P,)
    # Whether each of these effects has a parameter that is not at its null value, shape (K,)
    on: NDArray[np.uint8]
    body: Vector  # mass properties and rotors, in the layout of `lta_model.state`, shape (BODY,)
    inverse: Vector  # inverse of the mass matrix, rigid and added, row by row, shape (36,)
    # The parameters of every effect that is on, in the kernel or outside, by effect and name
    effect_parameters: Mapping[str, Mapping[str, float]]

    @classmethod
    def build(
        cls,
        effect_parameters: Mapping[str, Mapping[str, float]],
        *,
        mass: float,
        cg: ArrayLike,
        inertia: ArrayLike,
        displaced: float = 0.0,
        rotors: Sequence[tuple[ArrayLike, ArrayLike]] = (),
    ) -> Self:
        """
        Return the model of a vehicle.

        Parameters
        ----------
        effect_parameters : mapping
            Parameters by effect and name; the others are at their null value.
        mass, displaced : float
            Mass of the solid parts and of the gas, and mass of the displaced air. [kg]
        cg : array_like, shape (3,)
            Centre of gravity from the hull centre, body frame. [m]
        inertia : array_like, shape (3, 3) or (6,)
            About the centre of gravity; six elements are ixx ixy ixz iyy iyz izz of the tensor, as
            in geometry_msgs/Inertia. [kg m^2]
        rotors : sequence of (place, axis)
            Place from the hull centre [m] and unit direction of the thrust, body frame.

        Raises
        ------
        BadInput
            For an unknown effect or parameter, a value out of bounds, or an impossible mass or
            inertia.

        """
        rigid = _build_rigid_body(mass, cg, inertia, displaced)
        # Unknown names raise here, before anything is computed
        for name in effect_parameters:
            effects.get_effect(name)
        parameters: list[float] = []
        on: list[bool] = []
        values_by_effect: dict[str, dict[str, float]] = {}
        added = np.zeros(6)
        for name, effect in effects.EFFECTS.items():
            values = fill_parameters(effect, effect_parameters.get(name, {}))
            numbers = tuple(values.values())
            active = any(values[p.name] != p.null for p in effect.parameters)
            if active:
                values_by_effect[name] = values
            # Evaluated at each step; inertia and body effects act on the mass matrix here
            if isinstance(effect, KernelEffect):
                parameters.extend(numbers)
                on.append(active)
            elif isinstance(effect, InertiaEffect):
                added += effect.diagonal(numbers)
            elif isinstance(effect, BodyEffect) and active:
                rigid = effect.change(numbers, rigid)
        matrix = _build_mass_matrix(rigid) + np.diag(added)
        own = (rigid.mass, *rigid.moment, *rigid.inertia, *added, rigid.displaced)
        return cls(
            np.array(parameters),
            np.array(on, dtype=np.uint8),
            np.array([*own, *_pack_rotor_geometry(rotors)]),
            # The mass matrix is constant in flight, so it is inverted once
            np.linalg.inv(matrix).ravel().astype(np.float64),
            values_by_effect,
        )


Array = NDArray[np.float64]
STEP_NS = 2_500_000  # integration step; the shortest time constant of a shipped vehicle is 72 ms
RK4_LIMIT = 2.7  # longest stable step of RK4 by a time constant: 2.785, less a margin
SPEED_LIMIT = 1000.0  # m/s and rad/s; only a diverged simulation gets there


def find_fastest_damping(model: VehicleModel) -> tuple[str, float]:
    """Return the effect with the fastest linear damping and its rate; '' and 0 if none [1/s]."""
    inverse = model.inverse.reshape(6, 6)
    rates = {
        name: float(np.linalg.eigvals(inverse @ damping).real.max())
        for name, damping in compute_linear_damping(model).items()
    }
    return max(rates.items(), key=lambda item: item[1], default=('', 0.0))


def compute_linear_damping(model: VehicleModel) -> dict[str, Array]:
    """Return the damping of each effect that is linear in the velocity [N s/m, N m s]."""
    damping_by_effect = {}
    values = model.effect_parameters
    for name, axes in (('linear_drag', slice(0, 3)), ('rotational_drag', slice(3, 6))):
        if name in values:
            damping = np.zeros(6)
            # Only the linear coefficients: quadratic damping depends on the speed
            damping[axes] = [values[name][axis] for axis in AXES[axes]]
            damping_by_effect[name] = np.diag(damping)
    if 'floor_contact' in values:
        foot = values['floor_contact']
        # Jacobian of the foot's vertical velocity for an upright vehicle
        down = np.array([0.0, 0.0, 1.0, foot['y'], -foot['x'], 0.0])  # upright
        damping_by_effect['floor_contact'] = (
            foot['stiffness'] * foot['relaxation'] * np.outer(down, down)
        )
    if 'walls' in values:
        room = values['walls']
        push = room['stiffness'] * room['relaxation']
        damping_by_effect['walls'] = np.diag([push, push, push, 0.0, 0.0, 0.0])
    return damping_by_effect


def check_time_step(name: str, model: VehicleModel, step: float) -> None:
    """Raise `BadInput` for a time step [s] above 2.7 times the fastest damping time constant."""
    effect, rate = find_fastest_damping(model)
    if rate * step > RK4_LIMIT:
        raise BadInput(
            f'The effect {effect} of {name} damps motion within {1e3 / rate:.3g} ms, too '
            f'fast for the simulation time step of {1e3 * step:g} ms; make its damping '
            f'{rate * step / RK4_LIMIT:.2g} times weaker.'
        )


def has_diverged(state: Sequence[float]) -> bool:
    """Return whether a velocity or rate of a state is not finite or implausible."""
    # Velocity is state[7:10] and rates are state[10:13]; NaN compares false. Written out, because
    # compiled code has no generic tuples.
    return not (
        abs(state[7]) < SPEED_LIMIT
        and abs(state[8]) < SPEED_LIMIT
        and abs(state[9]) < SPEED_LIMIT
        and abs(state[10]) < SPEED_LIMIT
        and abs(state[11]) < SPEED_LIMIT
        and abs(state[12]) < SPEED_LIMIT
    )


def build_divergence_error(name: str, elapsed: float) -> BadInput:
    """Return the error for a diverged flight [s after the start]."""
    return BadInput(
        f'The simulation of {name} diverged {elapsed:.2f} s after the start, probably because '
        'one of its effects is too strong for its mass or inertia; check the values under '
        'effects in the vehicle file.'
    )
