# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Generate the source of one kernel that sums all effects.

The source contains the functions of the effects and of the rigid body (`extract`), and the glue
code below, which uses each effect's offset in the parameter vector and in the state. An effect
that is off costs one check of its flag.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from string import Template
from typing import final

from lta_config.compilation.compiler import ENTRY_DECORATOR, INNER_DECORATOR
from lta_config.compilation.extract import SourceExtract
from lta_model import rigid_body
from lta_model.effects.protocol import Effect, KernelEffect
from lta_sim.kernels.layout import EffectLayout, KernelAccess
from lta_sim.kernels.row import ROW_ENTRIES, RowAccess
from lta_sim.kernels.stages import build_stages

KERNEL_HEAD = '''"""
The model of a vehicle, written by lta_sim.kernels.compose from the effects; edits here are lost.

A state is a tuple: position, quaternion, velocity, rates, memory of the effects.
"""

from collections import namedtuple
import math

'''


@final
@dataclass(frozen=True, slots=True)
class KernelTarget:
    """Compilation target of the model."""

    imports: str  # import statements in addition to `math` and `namedtuple`
    # Decorators of internal functions and of entry points
    inline: str
    entry: str
    access: KernelAccess  # how the source accesses the numbers of a vehicle
    entries: Template  # entry points of this target; `render_kernel_source` fills in the layout


# One vehicle, in its row.
SCALAR = KernelTarget(
    'from numba import njit\n',
    INNER_DECORATOR,
    ENTRY_DECORATOR,
    RowAccess(),
    Template(ROW_ENTRIES),
)


def build_layout(effects: Mapping[str, Effect]) -> EffectLayout:
    """Return the layout of those effects that act inside the kernel."""
    return EffectLayout({n: e for n, e in effects.items() if isinstance(e, KernelEffect)})


def _build_template_parts(
    layout: EffectLayout, form: KernelTarget, extract: SourceExtract
) -> dict[str, str]:
    """Return the template parts that depend on the layout."""
    # The glue calls these functions by name
    for function in rigid_body.TAKEN:
        extract.add_function(function, 'rigid_body')
    parts = build_stages(layout, form.access, extract)
    return {'size': str(layout.size), **form.access.build_template_parts(parts, layout)}


def render_kernel_source(effects: Mapping[str, Effect], form: KernelTarget = SCALAR) -> str:
    """
    Return the kernel of these effects as the source of a module that needs only numba.

    The order of the effects defines the layout of parameter vector and memory. Effects that act
    outside the kernel are ignored.
    """
    extract = SourceExtract()
    layout = build_layout(effects)
    texts = {
        'INLINE': form.inline,
        'ENTRY': form.entry,
        **_build_template_parts(layout, form, extract),
    }
    glue = form.entries.substitute(texts)
    return f'{KERNEL_HEAD}{form.imports}\n\n{extract.render_pieces(form.inline)}\n\n{glue}'
