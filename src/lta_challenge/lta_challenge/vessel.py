"""A vehicle as the numbers that the truth is flown with."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import final

from lta_challenge.outside import STRANGE
from lta_challenge.truth_flight import ENTRIES
from lta_challenge.truth_source import APART, Composed, of_library
from lta_config.compilation.kernel_cache import load
from lta_config.errors import BadInput
from lta_discovery.model.nominal import Nominal
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import (
    AXES,
    BodyEffect,
    InertiaEffect,
    KernelEffect,
    MeasurementEffect,
    Rigid,
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
def composed() -> Composed:
    """Return what the truth consists of."""
    return Composed(of_library(), {name: one.effect for name, one in STRANGE.items()})


@cache
def truth(rotors: int) -> ModuleType:
    """Return the truth of a vehicle with some rotors, compiled at its first flight."""
    return load(composed().source(OWN, rotors, ENTRIES.replace('$entry', ENTRY)))


@final
@dataclass(frozen=True, slots=True)
class Vessel:
    """
    What the compiled truth takes of one vehicle.

    Attributes
    ----------
    parameters, on : ndarray
        Of the effects.
    body, inverse : ndarray, shape (BODY,) and (6, 6)
        As `lta_model.state` lays it out; inverse of the mass matrix.
    lift : ndarray, shape (1,)
        Gravity. [m/s2]
    allocation : ndarray, shape (rotors, 6)
        Wrench by newton of each rotor, toed as it is.
    readings : mapping of str to tuple
        The measurement effects that act on each channel, with their parameters.

    """

    parameters: Array
    on: NDArray[np.bool_]
    body: Array
    inverse: Array
    lift: Array
    allocation: Array
    readings: Mapping[str, tuple[tuple[MeasurementEffect, Values], ...]]

    @property
    def delay(self) -> float:
        """How late a command is obeyed. [s]"""
        return -float(self.read('command_time', (0.0,), 0.0)[0])

    def read(self, channel: str, values: tuple, time: object) -> tuple:  # type: ignore[type-arg]
        """Return what becomes of a reading, numbers or arrays."""
        for effect, p in self.readings.get(channel, ()):
            values = effect.reading(p, values, time)  # type: ignore[arg-type]
        return values


def skew(a: Array) -> Array:
    """Return S with S b = a x b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def turned(axis: Array, vector: Array) -> Array:
    """Return a vector turned by the length of an axis about it (Rodrigues)."""
    angle = float(np.linalg.norm(axis))
    if angle == 0.0:
        return vector
    k = skew(axis / angle)
    out: Array = vector + np.sin(angle) * k @ vector + (1.0 - np.cos(angle)) * k @ k @ vector
    return out


def _weighed(nominal: Nominal) -> Rigid:
    """Return the rigid body about the hull centre, with the effects that change it."""
    r, mass = np.asarray(nominal.cg), nominal.mass
    about = nominal.inertia + mass * (r @ r * np.eye(3) - np.outer(r, r))
    six = tuple(float(about[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    x, y, z = (mass * r).tolist()
    rigid = Rigid(mass, (x, y, z), six, nominal.displaced)  # type: ignore[arg-type]
    for name, effect in EFFECTS.items():
        if isinstance(effect, BodyEffect) and name in nominal.given:
            p = tuple(nominal.value(name, known.name) for known in effect.parameters)
            rigid = effect.change(p, rigid)
    return rigid


def _added(nominal: Nominal) -> Array:
    """Return added mass and inertia."""
    out = np.zeros(6)
    for name, effect in EFFECTS.items():
        if isinstance(effect, InertiaEffect):
            p = tuple(nominal.value(name, known.name) for known in effect.parameters)
            out += effect.diagonal(p)
    return out


def _matrix(rigid: Rigid, added: Array) -> Array:
    """Return the mass matrix about the hull centre."""
    xx, yy, zz, xy, xz, yz = rigid.inertia
    out = np.zeros((6, 6))
    out[:3, :3] = rigid.mass * np.eye(3)
    out[:3, 3:], out[3:, :3] = -skew(np.array(rigid.moment)), skew(np.array(rigid.moment))
    out[3:, 3:] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return out + np.diag(added)


def allocation(nominal: Nominal) -> Array:
    """Return the wrench of each rotor by newton; its axis turned as far as it is off."""
    rows = []
    for i, (place, axis) in enumerate(nominal.rotors, start=1):
        row = np.array([nominal.value('rotor_thrust', f'{name}_{i}') for name in AXES])
        first, second = (
            nominal.value('rotor_misalignment', f'{turn}_{i}') for turn in ('first', 'second')
        )
        upright = axis[2] ** 2 > 0.5
        e_1 = np.cross([0.0, 1.0, 0.0] if upright else [0.0, 0.0, 1.0], axis)
        e_1 /= np.linalg.norm(e_1)
        more = turned(first * e_1 + second * np.cross(axis, e_1), axis) - axis
        rows.append(row + np.concatenate([more, np.cross(place, more)]))
    return np.array(rows)


def _readings(nominal: Nominal) -> dict[str, tuple[tuple[MeasurementEffect, Values], ...]]:
    """Return the measurement effects that are on, by channel."""
    out: dict[str, tuple[tuple[MeasurementEffect, Values], ...]] = {}
    for name, effect in EFFECTS.items():
        if isinstance(effect, MeasurementEffect) and name in nominal.given:
            p = tuple(nominal.value(name, known.name) for known in effect.parameters)
            out[effect.channel] = (*out.get(effect.channel, ()), (effect, p))
    return out


def _parameters(nominal: Nominal, strange: Strange) -> tuple[Array, NDArray[np.bool_]]:
    """Return parameters and flags of all effects of the truth."""
    parts, values, on = composed(), list[float](), list[bool]()
    for name, effect in parts.all.items():
        if name in parts.strange:
            given = strange.get(name, {})
            own = [given.get(known.name, known.null) for known in effect.parameters]
        else:
            own = [nominal.value(name, known.name) for known in effect.parameters]
        differs = any(x != p.null for x, p in zip(own, effect.parameters, strict=True))
        values += own
        on.append(differs)
    return np.array(values), np.array(on)


def _refuse(nominal: Nominal) -> None:
    """Refuse a vehicle with an effect that the truth does not have."""
    own = {'weight_and_buoyancy', 'rotor_thrust', 'rotor_misalignment', 'floor_contact'}
    for name in APART - own:
        effect = EFFECTS[name]
        if isinstance(effect, KernelEffect) and any(
            nominal.value(name, known.name) != known.null for known in effect.parameters
        ):
            raise BadInput(
                f'The vehicle has {name}, which a challenge cannot fly; take a plain vehicle.'
            )


def vessel(nominal: Nominal, strange: Strange | None = None) -> Vessel:
    """
    Return a vehicle as the truth flies it.

    Parameters
    ----------
    nominal : Nominal
        Its numbers.
    strange : mapping
        Parameters of effects that are in no library, by name.

    Raises
    ------
    BadInput
        If it has an effect that the truth does not know.

    """
    _refuse(nominal)
    rigid, added = _weighed(nominal), _added(nominal)
    parameters, on = _parameters(nominal, strange or {})
    body = np.zeros(BODY)
    own = (rigid.mass, *rigid.moment, *rigid.inertia, *added, rigid.displaced)
    body[: len(own)] = own
    for k, (place, axis) in enumerate(nominal.rotors):
        body[17 + 6 * k : 23 + 6 * k] = np.concatenate([place, axis])
    return Vessel(
        parameters,
        on,
        body,
        np.linalg.inv(_matrix(rigid, added)).astype(np.float64),
        np.array([nominal.value('weight_and_buoyancy', 'gravity')]),
        allocation(nominal),
        _readings(nominal),
    )
