"""
The project's own effects, compiled for replaying a flight in pieces.

The way of a command to a thrust does not depend on how the body moves. So it is composed by
itself (`actuators`) and run once over a whole flight; the rest (`body`) is composed with rotors
that obey newtons, and with one more wrench, `latent`: the force and moment that nothing explains.
Both are `lta_sim.compose` of the registered effects with other entries, so that no physics is
written again.
"""

from collections.abc import Mapping
from functools import cache
from string import Template
from types import ModuleType
from typing import Final

from lta_sim.compose import ENTRY, Form, INLINE, kernel_source, layout_of
from lta_sim.effects import EFFECTS
from lta_sim.effects.protocol import (
    ActuatorEffect,
    AXES,
    Effect,
    KernelEffect,
    Motion,
    Parameter,
    Values,
    Wrench,
    WrenchEffect,
)
from lta_sim.kernel_cache import load
from lta_sim.row import ENTRIES, places, Row

LATENT: Final = 'latent'
_UNITS: Final = ('N', 'N', 'N', 'N m', 'N m', 'N m')


def wrench(p: Values, memory: Values, motion: Motion, thrust: Values) -> Wrench:
    """Return the force and moment themselves, in the body frame."""
    fx, fy, fz, tx, ty, tz = p
    return (fx, fy, fz, tx, ty, tz)


_EFFECT: Final = WrenchEffect(
    LATENT,
    tuple(
        Parameter(axis, unit, 0.0, -1e3, 1e3, 1e-3, 'what is not explained')
        for axis, unit in zip(AXES, _UNITS, strict=True)
    ),
    wrench,
    AXES,
)

ACTUATORS_ONLY: Final[dict[str, Effect]] = {
    name: effect for name, effect in EFFECTS.items() if isinstance(effect, ActuatorEffect)
}
BODY_ONLY: Final[dict[str, Effect]] = {
    **{
        name: effect
        for name, effect in EFFECTS.items()
        if isinstance(effect, KernelEffect) and not isinstance(effect, ActuatorEffect)
    },
    LATENT: _EFFECT,
}
ACTUATOR_LAYOUT: Final = layout_of(ACTUATORS_ONLY)
BODY_LAYOUT: Final = layout_of(BODY_ONLY)
ACTUATOR_PLACES: Final = places(ACTUATOR_LAYOUT)
BODY_PLACES: Final = places(BODY_LAYOUT)
RIGID: Final = 13

# Thrusts: the mean of each rotor in each bin, exact in when a command arrives; between arrivals
# steps no longer than `longest`, and the trapezium of their ends.
CHAIN: Final = '''

$ENTRY
def chain(row, on, arrivals, commands, around, begin, width, longest, out):
    """Write the mean thrust of each rotor in each bin of a flight."""
    newest, count = -1, arrivals.shape[0]
    now = begin
    for k in range(out.shape[0]):
        end = begin + (k + 1) * width
        for j in range(ROTORS):
            out[k, j] = 0.0
        while now < end:
            while newest + 1 < count and arrivals[newest + 1] <= now + 1e-9:
                newest += 1
                for j in range(ROTORS):
                    row[COMMAND + j] = commands[newest, j]
                for j in range(AROUND_SIZE):
                    row[AROUND + j] = around[newest, j]
            until = end
            if newest + 1 < count and arrivals[newest + 1] < end:
                until = arrivals[newest + 1]
            if until - now < 1e-9:
                now = until
                if until == end:
                    break
                continue
            steps = int(math.ceil((until - now) / longest - 1e-9))
            dt = (until - now) / steps
            for _ in range(steps):
                rates(row, on)
                for j in range(ROTORS):
                    out[k, j] += 0.5 * dt * row[THRUST + j]
                advance(row, on, dt, 1)
                rates(row, on)
                for j in range(ROTORS):
                    out[k, j] += 0.5 * dt * row[THRUST + j]
            now = until
        for j in range(ROTORS):
            out[k, j] /= width
'''

# Segment s begins at step first[s] of the flight; `memory` is that of the effects by step.
FLY: Final = '''

$INLINE
def meet(row, k, commands, around, memory):
    """Write what a step of the flight finds."""
    for j in range(COMMAND_SIZE):
        row[COMMAND + j] = commands[k, j]
    for j in range(AROUND_SIZE):
        row[AROUND + j] = around[k, j]
    for j in range(memory.shape[1]):
        row[RIGID + j] = memory[k, j]


$ENTRY
def fly(row, on, first, start, commands, around, memory, latent, dt, out):
    """Write the state of each segment at each step, by classical Runge-Kutta."""
    for s in range(first.shape[0]):
        for j in range(RIGID):
            row[j] = start[s, j]
            out[s, 0, j] = start[s, j]
        for k in range(out.shape[1] - 1):
            meet(row, first[s] + k, commands, around, memory)
            for j in range(6):
                row[LATENT + j] = latent[s, k, j]
            advance(row, on, dt, 1)
            for j in range(RIGID):
                out[s, k + 1, j] = row[j]


$ENTRY
def slopes(row, on, first, states, commands, around, memory, latent, out):
    """Write the rate of velocity and body rates at given states, and d/dt of the position."""
    row[TOLD] = 0.0
    for s in range(first.shape[0]):
        for k in range(states.shape[1]):
            for j in range(RIGID):
                row[j] = states[s, k, j]
            meet(row, first[s] + k, commands, around, memory)
            for j in range(6):
                row[LATENT + j] = latent[s, k, j]
            rates(row, on)
            for j in range(3):
                out[s, k, j] = row[RATE + j]
            for j in range(6):
                out[s, k, 3 + j] = row[RATE + 7 + j]


$ENTRY
def remember(row, on, states, commands, around, dt, out):
    """Write the memory of the effects at each step of a flight whose motion is known."""
    row[TOLD] = 0.0
    for k in range(states.shape[0]):
        for j in range(RIGID):
            row[j] = states[k, j]
        for j in range(COMMAND_SIZE):
            row[COMMAND + j] = commands[k, j]
        for j in range(AROUND_SIZE):
            row[AROUND + j] = around[k, j]
        for j in range(out.shape[1]):
            out[k, j] = row[RIGID + j]
        rates(row, on)
        for j in range(out.shape[1]):
            row[RIGID + j] += dt * row[RATE + RIGID + j]
'''


def _constants(where: Mapping[str, slice], latent: int) -> str:
    """Return where in a row the entries find things, as source."""
    named = {
        'COMMAND': where['command'].start,
        'COMMAND_SIZE': where['command'].stop - where['command'].start,
        'AROUND': where['surroundings'].start,
        'AROUND_SIZE': where['surroundings'].stop - where['surroundings'].start,
        'THRUST': where['thrusts'].start,
        'ROTORS': where['thrusts'].stop - where['thrusts'].start,
        'RATE': where['rate'].start,
        'TOLD': where['told'].start,
        'LATENT': latent,
        'RIGID': RIGID,
    }
    return '\n'.join(f'{name} = {value}' for name, value in named.items()) + '\n\n'


def _form(entries: str, where: Mapping[str, slice], latent: int = 0) -> Form:
    """Return the scalar form of the model with more entries."""
    text = _constants(where, latent) + ENTRIES + entries
    return Form('from numba import njit\n', INLINE, ENTRY, Row(), Template(text))


@cache
def actuators() -> ModuleType:
    """Return the compiled way of a command to a thrust, with `chain`."""
    return load(kernel_source(ACTUATORS_ONLY, _form(CHAIN, ACTUATOR_PLACES)))


@cache
def body() -> ModuleType:
    """Return the compiled motion under given thrusts, with `fly`, `slopes` and `remember`."""
    latent = BODY_PLACES['parameters'].start + BODY_LAYOUT.first[LATENT]
    return load(kernel_source(BODY_ONLY, _form(FLY, BODY_PLACES, latent)))
