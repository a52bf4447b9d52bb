"""Convert a vehicle to the arrays that the truth simulator uses."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import final

from lta_challenge.outside import STRANGE
from lta_challenge.truth_source import APART, library_effects, TruthModel
from lta_config.compilation.kernel_cache import load_kernel
from lta_config.errors import BadInput
from lta_discovery.model.nominal import NominalVehicle
from lta_model.effects import EFFECTS, MODEL_EFFECTS
from lta_model.effects.protocol import (
    AXES,
    BodyEffect,
    InertiaEffect,
    KernelEffect,
    MeasurementEffect,
    RigidBody,
    Values,
)
from lta_model.state import BODY
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Strange = Mapping[str, Mapping[str, float]]

OWN = "@njit(error_model='numpy', no_cpython_wrapper=True, no_cfunc_wrapper=True)"
ENTRY = "@njit(error_model='numpy', cache=True)"


@cache
def build_truth_model() -> TruthModel:
    """Return the effects of the truth simulator."""
    return TruthModel(library_effects(), {name: one.effect for name, one in STRANGE.items()})


@cache
def compile_truth(rotors: int) -> ModuleType:
    """Return the simulator for a number of rotors; it is compiled at its first flight."""
    return load_kernel(build_truth_model().render_simulator_source(OWN, ENTRY, rotors))


@final
@dataclass(frozen=True, slots=True)
class TruthVehicle:
    """The arrays of one vehicle for the compiled simulator."""

    # Parameters of all effects, and flags of the active effects
    parameters: Array
    on: NDArray[np.bool_]
    # Body in the layout of `lta_model.state`, and the inverse of the mass matrix, shape (BODY,)
    body: Array
    inverse: Array
    lift: Array  # gravity, shape (1,) [m/s2]
    allocation: Array  # wrench per newton of each rotor, misalignment included, shape (rotors, 6)
    # Measurement effects of each channel, with their parameters
    readings: Mapping[str, tuple[tuple[MeasurementEffect, Values], ...]]

    @property
    def command_delay(self) -> float:
        """Delay from a command to its effect. [s]"""
        # The effect shifts a time backwards, so the delay is its negative value at zero
        return -float(self.apply_measurement_effects('command_time', (0.0,), 0.0)[0])

    def apply_measurement_effects(self, channel: str, values: tuple, time: object) -> tuple:  # type: ignore[type-arg]
        """Apply the measurement effects of a channel to readings (numbers or arrays)."""
        for effect, p in self.readings.get(channel, ()):
            values = effect.reading(p, values, time)  # type: ignore[arg-type]
        return values


def skew_matrix(a: Array) -> Array:
    """Return S with S b = a x b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def rotate_vector(axis: Array, vector: Array) -> Array:
    """Rotate a vector by a rotation vector (Rodrigues)."""
    angle = float(np.linalg.norm(axis))
    if angle == 0.0:
        return vector
    k = skew_matrix(axis / angle)
    out: Array = vector + np.sin(angle) * k @ vector + (1.0 - np.cos(angle)) * k @ k @ vector
    return out


def _build_rigid_body(nominal: NominalVehicle) -> RigidBody:
    """Return the rigid body about the hull centre, with the effects that change it."""
    r, mass = np.asarray(nominal.cg), nominal.mass
    # Steiner: from the centre of gravity to the hull centre
    about = nominal.inertia + mass * (r @ r * np.eye(3) - np.outer(r, r))
    # xx, yy, zz, xy, xz, yz
    six = tuple(float(about[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    x, y, z = (mass * r).tolist()
    rigid = RigidBody(mass, (x, y, z), six, nominal.displaced)  # type: ignore[arg-type]
    for name, effect in EFFECTS.items():
        if isinstance(effect, BodyEffect) and name in nominal.effect_parameters:
            p = tuple(
                nominal.parameter_value(name, parameter.name) for parameter in effect.parameters
            )
            rigid = effect.change(p, rigid)
    return rigid


def _added_mass(nominal: NominalVehicle) -> Array:
    """Return added mass and inertia."""
    out = np.zeros(6)
    for name, effect in EFFECTS.items():
        if isinstance(effect, InertiaEffect):
            p = tuple(
                nominal.parameter_value(name, parameter.name) for parameter in effect.parameters
            )
            out += effect.diagonal(p)
    return out


def _mass_matrix(rigid: RigidBody, added: Array) -> Array:
    """Return the mass matrix about the hull centre."""
    xx, yy, zz, xy, xz, yz = rigid.inertia
    out = np.zeros((6, 6))
    out[:3, :3] = rigid.mass * np.eye(3)
    out[:3, 3:], out[3:, :3] = (
        -skew_matrix(np.array(rigid.moment)),
        skew_matrix(np.array(rigid.moment)),
    )
    out[3:, 3:] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return out + np.diag(added)


def allocation_matrix(nominal: NominalVehicle) -> Array:
    """Return the wrench per newton of each rotor, with its axis misaligned."""
    rows = []
    for i, (place, axis) in enumerate(nominal.rotors, start=1):
        row = np.array([nominal.parameter_value('rotor_thrust', f'{name}_{i}') for name in AXES])
        first, second = (
            nominal.parameter_value('rotor_misalignment', f'{turn}_{i}')
            for turn in ('first', 'second')
        )
        # First perpendicular axis: from body y for upright rotors and from body z for the others
        upright = axis[2] ** 2 > 0.5
        e_1 = np.cross([0.0, 1.0, 0.0] if upright else [0.0, 0.0, 1.0], axis)
        e_1 /= np.linalg.norm(e_1)
        # Change of the thrust direction, which is added to the column
        more = rotate_vector(first * e_1 + second * np.cross(axis, e_1), axis) - axis
        rows.append(row + np.concatenate([more, np.cross(place, more)]))
    return np.array(rows)


def _collect_measurement_effects(
    nominal: NominalVehicle,
) -> dict[str, tuple[tuple[MeasurementEffect, Values], ...]]:
    """Return the active measurement effects by channel."""
    out: dict[str, tuple[tuple[MeasurementEffect, Values], ...]] = {}
    for name, effect in EFFECTS.items():
        if isinstance(effect, MeasurementEffect) and name in nominal.effect_parameters:
            p = tuple(
                nominal.parameter_value(name, parameter.name) for parameter in effect.parameters
            )
            out[effect.channel] = (*out.get(effect.channel, ()), (effect, p))
    return out


def _collect_parameters(
    nominal: NominalVehicle, strange: Strange
) -> tuple[Array, NDArray[np.bool_]]:
    """Return parameters and flags of all effects."""
    parts, values, on = build_truth_model(), list[float](), list[bool]()
    for name, effect in parts.all_effects.items():
        if name in parts.strange:
            changed = strange.get(name, {})
            own = [changed.get(parameter.name, parameter.null) for parameter in effect.parameters]
        else:
            own = [
                nominal.parameter_value(name, parameter.name) for parameter in effect.parameters
            ]
        # An effect with null values is skipped, so it costs no time
        differs = any(x != p.null for x, p in zip(own, effect.parameters, strict=True))
        values += own
        on.append(differs)
    return np.array(values), np.array(on)


def _check_effects(nominal: NominalVehicle) -> None:
    """Raise `BadInput` if the vehicle has an effect that the simulator lacks."""
    # Implemented by the truth itself, or (floor contact) without effect in flight
    own = {'weight_and_buoyancy', 'rotor_thrust', 'rotor_misalignment', 'floor_contact'}
    for name in APART - own:
        effect = MODEL_EFFECTS[name]
        if isinstance(effect, KernelEffect) and any(
            nominal.parameter_value(name, parameter.name) != parameter.null
            for parameter in effect.parameters
        ):
            raise BadInput(
                f'The vehicle has the effect {name}, which the simulator of the challenges does '
                'not model; remove it from the vehicle file.'
            )


def build_truth_vehicle(nominal: NominalVehicle, strange: Strange | None = None) -> TruthVehicle:
    """
    Build the arrays of a vehicle for the truth simulator.

    `strange`: parameters of effects outside the library, by name. Raise `BadInput` if the vehicle
    has an effect that the simulator lacks.
    """
    _check_effects(nominal)
    rigid, added = _build_rigid_body(nominal), _added_mass(nominal)
    parameters, on = _collect_parameters(nominal, strange or {})
    body = np.zeros(BODY)
    own = (rigid.mass, *rigid.moment, *rigid.inertia, *added, rigid.displaced)
    body[: len(own)] = own
    for k, (place, axis) in enumerate(nominal.rotors):
        # After 17 numbers of the body: position and axis of each rotor
        body[17 + 6 * k : 23 + 6 * k] = np.concatenate([place, axis])
    return TruthVehicle(
        parameters,
        on,
        body,
        np.linalg.inv(_mass_matrix(rigid, added)).astype(np.float64),
        np.array([nominal.parameter_value('weight_and_buoyancy', 'gravity')]),
        allocation_matrix(nominal),
        _collect_measurement_effects(nominal),
    )
