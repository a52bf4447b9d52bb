# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compile the registered effects for replaying a flight in pieces.

The path from command to thrust does not depend on the motion. It is compiled separately
(`load_actuator_kernel`) and runs once over a whole flight. The other effects (`load_body_kernel`)
are compiled with thrusts as input, and with an additional wrench `latent`: the unexplained force
and moment.
Both reuse the registered effects through `lta_sim.kernels.compose`.
"""

from collections.abc import Mapping
from functools import cache
from string import Template
from types import ModuleType
from typing import Final, final

from lta_config.compilation.compiler import ENTRY_DECORATOR, INNER_DECORATOR
from lta_config.compilation.kernel_cache import load_kernel
from lta_discovery.model.replay_entries import CHAIN, REPLAY_ENTRY
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
from lta_sim.kernels.compose import build_layout, KernelTarget, render_kernel_source
from lta_sim.kernels.layout import EffectLayout, KernelAccess, ModelStage
from lta_sim.kernels.row import ROW_ENTRIES, row_slices, RowAccess

LATENT: Final = 'latent'
_UNITS: Final = ('N', 'N', 'N', 'N m', 'N m', 'N m')


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the parameters as force and moment, in the body frame."""
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
ACTUATOR_PLACES: Final = row_slices(ACTUATOR_LAYOUT)
BODY_PLACES: Final = row_slices(BODY_LAYOUT)
RIGID: Final = 13
# Release the GIL, so that flights run in parallel.
NOGIL: Final = ENTRY_DECORATOR.replace('cache=True', 'cache=True, nogil=True')


@final
class _RowOfRotors:
    """Access parameters as `RowAccess` does, but compute only the rotors."""

    loops = True

    def __init__(self) -> None:
        self._row = RowAccess()
        self.format_number = self._row.format_number
        self.format_all_numbers = self._row.format_all_numbers

    def build_template_parts(
        self, stages: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return the parts of the source that depend on the layout."""
        still = ModelStage(
            ('wind = (0.0, 0.0, 0.0)',)
        )  # required by the source, but not used by rotors
        return self._row.build_template_parts(
            [*(stage for stage in stages if stage.each), still], layout
        )


def _format_constants(where: Mapping[str, slice], latent: int) -> str:
    """Return the row indices of the entries as source."""
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


def _build_scalar_form(
    entries: str, where: Mapping[str, slice], access: KernelAccess, latent: int = 0
) -> KernelTarget:
    """Return the scalar form of the model with more entries."""
    text = _format_constants(where, latent) + ROW_ENTRIES + entries.replace('$FREE', NOGIL)
    return KernelTarget(
        'from numba import njit\n', INNER_DECORATOR, ENTRY_DECORATOR, access, Template(text)
    )


@cache
def load_actuator_kernel() -> ModuleType:
    """Return the compiled path from command to thrust, with `chain`."""
    return load_kernel(
        render_kernel_source(
            ACTUATORS_ONLY, _build_scalar_form(CHAIN, ACTUATOR_PLACES, _RowOfRotors())
        )
    )


@cache
def load_body_kernel() -> ModuleType:
    """Return the compiled motion under given thrusts, with the entries of `REPLAY_ENTRY`."""
    latent = BODY_PLACES['parameters'].start + BODY_LAYOUT.first[LATENT]
    return load_kernel(
        render_kernel_source(
            BODY_ONLY, _build_scalar_form(REPLAY_ENTRY, BODY_PLACES, RowAccess(), latent)
        )
    )
