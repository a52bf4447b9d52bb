"""
The project's own effects, compiled for replaying a flight in pieces.

The way of a command to a thrust does not depend on how the body moves. So it is composed by
itself (`load_actuators`) and run once over a whole flight; the rest (`load_body`) is composed with
rotors
that obey newtons, and with one more wrench, `latent`: the force and moment that nothing explains.
Both are `lta_sim.kernels.compose` of the registered effects with other entries, so that no
physics is written again.
"""

from collections.abc import Mapping
from functools import cache
from string import Template
from types import ModuleType
from typing import Final, final

from lta_config.compilation.compiler import ENTRY, INLINE
from lta_config.compilation.kernel_cache import load_kernel
from lta_discovery.model.replay_entries import CHAIN, FLY
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import (
    ActuatorEffect,
    AXES,
    Effect,
    EffectParameter,
    KernelEffect,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_sim.kernels.compose import build_layout, KernelForm, write_kernel_source
from lta_sim.kernels.layout import EffectLayout, KernelAccess, ModelStage
from lta_sim.kernels.row import ENTRIES, row_places, RowAccess

LATENT: Final = 'latent'
_UNITS: Final = ('N', 'N', 'N', 'N m', 'N m', 'N m')


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the force and moment themselves, in the body frame."""
    fx, fy, fz, tx, ty, tz = p
    return (fx, fy, fz, tx, ty, tz)


_EFFECT: Final = WrenchEffect(
    LATENT,
    tuple(
        EffectParameter(axis, unit, 0.0, -1e3, 1e3, 1e-3, 'what is not explained')
        for axis, unit in zip(AXES, _UNITS, strict=True)
    ),
    compute_wrench,
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
ACTUATOR_LAYOUT: Final = build_layout(ACTUATORS_ONLY)
BODY_LAYOUT: Final = build_layout(BODY_ONLY)
ACTUATOR_PLACES: Final = row_places(ACTUATOR_LAYOUT)
BODY_PLACES: Final = row_places(BODY_LAYOUT)
RIGID: Final = 13
# While these run, others can.
FREE: Final = ENTRY.replace('cache=True', 'cache=True, nogil=True')


@final
class _RowOfRotors:
    """Reach the numbers as in a `RowAccess`, and compute what the rotors do and nothing else."""

    loops = True

    def __init__(self) -> None:
        self._row = RowAccess()
        self.format_item, self.format_whole = self._row.format_item, self._row.format_whole

    def build_parts(self, stages: list[ModelStage], layout: EffectLayout) -> dict[str, str]:
        """Return the parts of the text that know the layout."""
        still = ModelStage(('wind = (0.0, 0.0, 0.0)',))  # which is told, but never asked for
        return self._row.build_parts([*(stage for stage in stages if stage.each), still], layout)


def _format_constants(where: Mapping[str, slice], latent: int) -> str:
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
        'SIZE': where['state'].stop,
        'KEPT': where['begin'].start,
        'MEAN': where['middle'].start,
        'LATENT': latent,
        'RIGID': RIGID,
    }
    return '\n'.join(f'{name} = {value}' for name, value in named.items()) + '\n\n'


def _build_form(
    entries: str, where: Mapping[str, slice], access: KernelAccess, latent: int = 0
) -> KernelForm:
    """Return the scalar form of the model with more entries."""
    text = _format_constants(where, latent) + ENTRIES + entries.replace('$FREE', FREE)
    return KernelForm('from numba import njit\n', INLINE, ENTRY, access, Template(text))


@cache
def load_actuators() -> ModuleType:
    """Return the compiled way of a command to a thrust, with `chain`."""
    return load_kernel(
        write_kernel_source(ACTUATORS_ONLY, _build_form(CHAIN, ACTUATOR_PLACES, _RowOfRotors()))
    )


@cache
def load_body() -> ModuleType:
    """Return the motion under given thrusts: `fly`, `jacobians`, `answers`, `remember`."""
    latent = BODY_PLACES['parameters'].start + BODY_LAYOUT.first[LATENT]
    return load_kernel(
        write_kernel_source(BODY_ONLY, _build_form(FLY, BODY_PLACES, RowAccess(), latent))
    )
