"""
Write the source of one kernel that is the sum of all effects.

The text holds the effects' own functions (`extract`), the rigid body's, and the glue below that
knows where in the parameter vector and in the state each effect lives. All effects are always in
it: one that is at its null values costs a look at its flag, and switching it on is a number, not a
compilation.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from string import Template
from typing import final

from lta_config.compilation.compiled import ENTRY, INLINE
from lta_config.compilation.extract import Extract
from lta_model import rigid_body
from lta_model.effects.protocol import Effect, KernelEffect
from lta_sim.kernels.layout import Access, Layout
from lta_sim.kernels.row import ENTRIES, Row
from lta_sim.kernels.stages import stages

HEAD = '''"""
The model of a vehicle, written by lta_sim.kernels.compose from the effects; edits here are lost.

A state is a tuple: position, quaternion, velocity, rates, memory of the effects.
"""

from collections import namedtuple
import math

'''


@final
@dataclass(frozen=True, slots=True)
class Form:
    """
    What the model is compiled for.

    Parameters
    ----------
    imports : str
        What the text needs beside `math` and `namedtuple`.
    inline, entry : str
        Decorators of the model's own functions and of those that are called from outside.
    access : Access
        How the numbers of a vehicle are reached.
    entries : Template
        The functions that know the form; `kernel_source` fills in the layout.

    """

    imports: str
    inline: str
    entry: str
    access: Access
    entries: Template


# One vehicle, in its row.
SCALAR = Form('from numba import njit\n', INLINE, ENTRY, Row(), Template(ENTRIES))


def layout_of(effects: Mapping[str, Effect]) -> Layout:
    """Return where everything of these effects is."""
    return Layout({n: e for n, e in effects.items() if isinstance(e, KernelEffect)})


def _texts(layout: Layout, form: Form, extract: Extract) -> dict[str, str]:
    """Return the parts of the text that know the layout."""
    for function in rigid_body.TAKEN:
        extract.add(function, 'rigid_body')
    parts = stages(layout, form.access, extract)
    return {'size': str(layout.size), **form.access.texts(parts, layout)}


def kernel_source(effects: Mapping[str, Effect], form: Form = SCALAR) -> str:
    """
    Return the kernel of these effects as Python source.

    Parameters
    ----------
    effects : mapping of str to Effect
        Their order is the layout of the parameter vector and of the memory; those that act
        outside the kernel are passed over.
    form : Form
        What it is compiled for; by default one vehicle, with `derivative` and `advance`.

    Returns
    -------
    str
        A module that needs only numba.

    """
    extract = Extract()
    layout = layout_of(effects)
    texts = {'INLINE': form.inline, 'ENTRY': form.entry, **_texts(layout, form, extract)}
    glue = form.entries.substitute(texts)
    return f'{HEAD}{form.imports}\n\n{extract.text(form.inline)}\n\n{glue}'
