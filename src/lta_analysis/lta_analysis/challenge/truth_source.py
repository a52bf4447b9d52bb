"""
The source of the truth: a vehicle in air, composed apart from the model that is put to the test.

Of the project it takes the effects' own equations only (`lta_sim.effects`): the rest is written
anew and in another form, so that an error of the model's integrator, rigid body, rotors or command
path is not in both. The state has the rotation matrix instead of a quaternion, and momentum in the
axes of the map instead of body velocity. With P the momentum of the body and of the air that moves
with it, L the same about the hull centre, W the wind there (Kirchhoff; Auton et al. 1988):

    P = R (m v + w x m r + A (v - R' W)),   L = R (I w + m r x v + A_2 w)
    d/dt P = R F + R (m_d + A) R' DU/Dt - R A R' dW/dt
    d/dt L = R (N - v x p_rb - v_r x A v_r)

DU/Dt and dW/dt are differences of the wind along the way of the air and of the hull. Weight,
buoyancy and the wrench of the rotors, toed by an exact rotation, are written here as well.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from string import Template
from typing import Final, final

from lta_sim.effects import EFFECTS
from lta_sim.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    KernelEffect,
    Motion,
    no_rate,
    no_rotor_rate,
    Place,
    WrenchEffect,
)
from lta_sim.extract import Extract
from lta_sim.state import ACTUATORS

# Written here, or not in a free flight of a vehicle with a plain hull.
APART: Final = frozenset(
    {
        'weight_and_buoyancy', 'rotor_thrust', 'rotor_misalignment', 'floor_contact', 'walls',
        'wind_profile', 'turbulence', 'gusts', 'superheat', 'moving_mass', 'hull_lift',
        'thrust_polynomial', 'rotor_envelope_interaction', 'ceiling_effect',
    }
)  # fmt: skip
RIGID: Final = 18  # position, rotation matrix, momentum, angular momentum
TEMPLATE: Final = '''"""The truth of a challenge, by lta_analysis.challenge; edits here are lost."""

from collections import namedtuple
import math

from numba import njit
import numpy as np

Motion = namedtuple('Motion', $motion)
Place = namedtuple('Place', $place)
ROTORS = $rotors
SIZE = $size


$functions


$own
def wind_at(x, y, z, p, on, around):
    """Return the wind at a place."""
    u, v, w = 0.0, 0.0, 0.0
    at, still = (x, y, z), (0.0, 0.0, 0.0)
$air
    return u, v, w


$own
def turned(y, a, b, c):
    """Return a map vector in body axes."""
    return (y[3] * a + y[6] * b + y[9] * c, y[4] * a + y[7] * b + y[10] * c,
            y[5] * a + y[8] * b + y[11] * c)


$own
def speeds(y, p, on, around, body, inverse, out):
    """Write velocity and rates, body axes, then the wind in body axes."""
    u, v, w = wind_at(y[0], y[1], y[2], p, on, around)
    a, b, c = turned(y, u, v, w)
    d, e, f = turned(y, y[12], y[13], y[14])
    g, h, i = turned(y, y[15], y[16], y[17])
    q = (d + body[10] * a, e + body[11] * b, f + body[12] * c, g, h, i)
    for k in range(6):
        out[k] = 0.0
        for j in range(6):
            out[k] += inverse[k, j] * q[j]
    out[6], out[7], out[8] = a, b, c


$own
def rotors(y, dy, told, p, on, around, u):
    """Write the thrust of each rotor."""
    for j in range(ROTORS):
        value = told[j]
$actuators
        u[j] = value


$own
def slope(y, dy, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra):
    """Write d/dt of the state; `extra` takes what no vehicle file has."""
    for k in range(SIZE):
        dy[k] = 0.0
    speeds(y, p, on, around, body, inverse, s)
    rotors(y, dy, told, p, on, around, u)
    r = (y[3], y[4], y[5], y[6], y[7], y[8], y[9], y[10], y[11])
    v, w = (s[0], s[1], s[2]), (s[3], s[4], s[5])
    air = (v[0] - s[6], v[1] - s[7], v[2] - s[8])
    motion = Motion((y[0], y[1], y[2]), r, v, w, air, body, told, around)
    # Weight and buoyancy along the vertical seen from the body; the moment is m r x (-g up).
    g, net = lift[0], lift[0] * (body[16] - body[0])
    f0, f1, f2 = net * r[6], net * r[7], net * r[8]
    n0 = -g * (body[2] * r[8] - body[3] * r[7])
    n1 = -g * (body[3] * r[6] - body[1] * r[8])
    n2 = -g * (body[1] * r[7] - body[2] * r[6])
    if pushed:
        f0, f1, f2 = f0 + told[0], f1 + told[1], f2 + told[2]
        n0, n1, n2 = n0 + told[3], n1 + told[4], n2 + told[5]
    else:
        for j in range(ROTORS):
            f0 += allocation[j, 0] * u[j]
            f1 += allocation[j, 1] * u[j]
            f2 += allocation[j, 2] * u[j]
            n0 += allocation[j, 3] * u[j]
            n1 += allocation[j, 4] * u[j]
            n2 += allocation[j, 5] * u[j]
    for k in range(6):
        extra[k] = 0.0
$wrenches
    f0, f1, f2 = f0 + extra[0], f1 + extra[1], f2 + extra[2]
    n0, n1, n2 = n0 + extra[3], n1 + extra[4], n2 + extra[5]
    # What the body has of the momentum, and the air.
    b0 = body[0] * v[0] + w[1] * body[3] - w[2] * body[2]
    b1 = body[0] * v[1] + w[2] * body[1] - w[0] * body[3]
    b2 = body[0] * v[2] + w[0] * body[2] - w[1] * body[1]
    a0, a1, a2 = body[10] * air[0], body[11] * air[1], body[12] * air[2]
    n0 -= v[1] * b2 - v[2] * b1 + air[1] * a2 - air[2] * a1
    n1 -= v[2] * b0 - v[0] * b2 + air[2] * a0 - air[0] * a2
    n2 -= v[0] * b1 - v[1] * b0 + air[0] * a1 - air[1] * a0
    x0 = r[0] * v[0] + r[1] * v[1] + r[2] * v[2]
    x1 = r[3] * v[0] + r[4] * v[1] + r[5] * v[2]
    x2 = r[6] * v[0] + r[7] * v[1] + r[8] * v[2]
    if $windy:
        h = 1e-3
        e0, e1, e2 = wind_at(y[0], y[1], y[2], p, on, around)
        c0, c1, c2 = wind_at(y[0] + h * e0, y[1] + h * e1, y[2] + h * e2, p, on, around)
        d0, d1, d2 = wind_at(y[0] - h * e0, y[1] - h * e1, y[2] - h * e2, p, on, around)
        k0, k1, k2 = turned(y, (c0 - d0) / (2 * h), (c1 - d1) / (2 * h), (c2 - d2) / (2 * h))
        c0, c1, c2 = wind_at(y[0] + h * x0, y[1] + h * x1, y[2] + h * x2, p, on, around)
        d0, d1, d2 = wind_at(y[0] - h * x0, y[1] - h * x1, y[2] - h * x2, p, on, around)
        l0, l1, l2 = turned(y, (c0 - d0) / (2 * h), (c1 - d1) / (2 * h), (c2 - d2) / (2 * h))
        f0 += (body[16] + body[10]) * k0 - body[10] * l0
        f1 += (body[16] + body[11]) * k1 - body[11] * l1
        f2 += (body[16] + body[12]) * k2 - body[12] * l2
    dy[0], dy[1], dy[2] = x0, x1, x2
    for k in range(3):
        a, b, c = y[3 + 3 * k], y[4 + 3 * k], y[5 + 3 * k]
        dy[3 + 3 * k] = b * w[2] - c * w[1]
        dy[4 + 3 * k] = c * w[0] - a * w[2]
        dy[5 + 3 * k] = a * w[1] - b * w[0]
        dy[12 + k] = a * f0 + b * f1 + c * f2
        dy[15 + k] = a * n0 + b * n1 + c * n2
'''


def _tuple(name: str, first: int, count: int) -> str:
    """Return the source of a tuple of neighbours in an array."""
    return '(' + ''.join(f'{name}[{first + k}], ' for k in range(count)).rstrip() + ')'


@final
@dataclass(frozen=True, slots=False)
class Composed:
    """
    What the truth consists of, and where its numbers are.

    Attributes
    ----------
    effects : mapping of str to effect
        Of the library.
    strange : mapping of str to WrenchEffect
        Those that are in no library.

    """

    effects: Mapping[str, KernelEffect]
    strange: Mapping[str, WrenchEffect]

    @cached_property
    def all(self) -> dict[str, KernelEffect]:
        """All of them, those of the library first."""
        return {**self.effects, **self.strange}

    @cached_property
    def first(self) -> dict[str, int]:
        """Where the parameters of each begin."""
        out, count = {}, 0
        for name, effect in self.all.items():
            out[name] = count
            count += len(effect.parameters)
        return out

    @cached_property
    def parameters(self) -> int:
        """How many parameters there are."""
        return sum(len(effect.parameters) for effect in self.all.values())

    @cached_property
    def remembers(self) -> dict[str, int]:
        """Where the memory of each begins."""
        out, count = {}, RIGID
        for name, effect in self.all.items():
            out[name] = count
            each = ACTUATORS if isinstance(effect, ActuatorEffect) else 1
            count += each * len(effect.memory)
        return out

    @cached_property
    def memory(self) -> tuple[float, ...]:
        """What all memories begin with."""
        return tuple(
            value
            for effect in self.all.values()
            for _ in range(ACTUATORS if isinstance(effect, ActuatorEffect) else 1)
            for _, value in effect.memory
        )

    @property
    def size(self) -> int:
        """How many numbers a state has."""
        return RIGID + len(self.memory)

    def flag(self, name: str) -> int:
        """Return the place of an effect's flag."""
        return list(self.all).index(name)

    def _air(self, extract: Extract) -> list[str]:
        """Return the lines that add up the wind."""
        lines = []
        for name, effect in self.all.items():
            if isinstance(effect, AirEffect):
                p = _tuple('p', self.first[name], len(effect.parameters))
                call = extract.add(effect.air, name)
                lines += [
                    f'if on[{self.flag(name)}]:',
                    f'    e = {call}({p}, (), Place(at, still, (u, v, w), around))',
                    '    u, v, w = u + e[0], v + e[1], w + e[2]',
                ]
        return lines

    def _actuators(self, extract: Extract) -> list[str]:
        """Return the lines that take a command through one rotor."""
        lines = []
        for name, effect in self.all.items():
            if not isinstance(effect, ActuatorEffect):
                continue
            first, shared = self.first[name], len(effect.shared)
            parts = [f'p[{first + k}]' for k in range(shared)]
            parts += [f'p[{first + shared + ACTUATORS * k} + j]' for k in range(len(effect.each))]
            size, place = len(effect.memory), self.remembers[name]
            memory = ''.join(f'y[{place + k} + {size} * j], ' for k in range(size)).rstrip()
            lines += [
                f'if on[{self.flag(name)}]:',
                f'    q = ({", ".join(parts)},)',
                f'    m = ({memory})',
                '    given = value',
                f'    value = {extract.add(effect.output, name)}(q, m, given, around)',
            ]
            if effect.rate is not no_rotor_rate:
                lines.append(f'    e = {extract.add(effect.rate, name)}(q, m, given, around)')
                lines += [f'    dy[{place + k} + {size} * j] = e[{k}]' for k in range(size)]
        return lines

    def _wrenches(self, extract: Extract) -> list[str]:
        """Return the lines that add up forces and moments."""
        lines = []
        for name, effect in self.all.items():
            if not isinstance(effect, WrenchEffect):
                continue
            p = _tuple('p', self.first[name], len(effect.parameters))
            m = _tuple('y', self.remembers[name], len(effect.memory))
            lines += [
                f'if on[{self.flag(name)}]:',
                f'    q, m = {p}, {m}',
                f'    e = {extract.add(effect.wrench, name)}(q, m, motion, u)',
            ]
            if name in self.strange:
                lines.append('    for k in range(6): extra[k] += e[k]')
            else:
                lines.append('    f0, f1, f2 = f0 + e[0], f1 + e[1], f2 + e[2]')
                lines.append('    n0, n1, n2 = n0 + e[3], n1 + e[4], n2 + e[5]')
            if effect.rate is not no_rate:
                lines.append(f'    e = {extract.add(effect.rate, name)}(q, m, motion)')
                place = self.remembers[name]
                lines += [f'    dy[{place + k}] = e[{k}]' for k in range(len(effect.memory))]
        return lines

    def source(self, own: str, rotors: int, entries: str) -> str:
        """
        Return the text of the truth.

        Parameters
        ----------
        own : str
            Decorator of its functions.
        rotors : int
            How many the vehicle has.
        entries : str
            What is called from outside.

        """
        extract = Extract()
        parts = {
            'air': (self._air(extract), 1),
            'actuators': (self._actuators(extract), 2),
            'wrenches': (self._wrenches(extract), 1),
        }
        texts = {
            name: '\n'.join('    ' * depth + line for line in lines)
            for name, (lines, depth) in parts.items()
        }
        winds = [f'on[{self.flag(n)}]' for n, e in self.all.items() if isinstance(e, AirEffect)]
        return Template(TEMPLATE + entries).substitute(
            own=own,
            rotors=rotors,
            size=self.size,
            motion=repr(Motion._fields),
            place=repr(Place._fields),
            windy=' or '.join(winds) or 'False',
            functions=extract.text(own),
            **texts,
        )


def of_library() -> dict[str, KernelEffect]:
    """Return the effects of the library that the truth takes the equations of."""
    return {
        name: effect
        for name, effect in EFFECTS.items()
        if isinstance(effect, KernelEffect) and name not in APART
    }
