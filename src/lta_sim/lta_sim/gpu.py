"""
Many vehicles on a GPU, one a thread: the same effects, compiled with numba-cuda.

Needs an NVIDIA GPU and what requirements-gpu.txt lists. Double precision; products and sums may be
fused there, so that a flight differs from the CPU's in the last bits.
"""

from functools import cache
from importlib import import_module
from string import Template
from types import ModuleType

from lta_config.errors import BadInput
from lta_sim.compose import COLUMNS, Form, kernel_source
from lta_sim.effects import EFFECTS
from lta_sim.fleet import columns, Fleet
from lta_sim.kernel_cache import load
import numpy as np
from numpy.typing import ArrayLike, NDArray

# Few threads a block: each holds a whole vehicle, and the registers of a processor are shared.
THREADS = 64

ENTRIES = '''
$ENTRY
def advance_many(fixed, states, count, dt, steps):
    """Advance vehicle i, a column of the blocks, in thread i."""
    i = cuda.grid(1)
    if i < count:
        parameters, body, inverse, duty, wind = fixed_of(fixed, count, i)
        state = state_of(states, count, i)
        for _ in range(steps):
            a = rates(state, parameters, body, inverse, duty, wind)
            b = rates(ahead(state, a, 0.5 * dt), parameters, body, inverse, duty, wind)
            c = rates(ahead(state, b, 0.5 * dt), parameters, body, inverse, duty, wind)
            d = rates(ahead(state, c, dt), parameters, body, inverse, duty, wind)
            state = normalised(ahead(state, mean(a, b, c, d), dt))
        put(states, count, i, state)
'''

FORM = Form(
    'from numba import cuda\n',
    '@cuda.jit(device=True)',
    '@cuda.jit',
    Template(COLUMNS.template + '\n' + ENTRIES),
)


def _cuda() -> ModuleType:
    """
    Return numba's CUDA target with a GPU that it can use.

    Raises
    ------
    BadInput
        If there is none.

    """
    # numba-cuda 0.30 still names a function that numpy 2.5 has removed.
    vars(np).setdefault('row_stack', np.vstack)
    try:
        cuda = import_module('numba.cuda')
    except ImportError as error:
        raise BadInput(
            f'numba-cuda cannot be imported ({error}); install what requirements-gpu.txt lists '
            'or simulate on the CPU.'
        ) from None
    if not cuda.is_available():
        raise BadInput(
            'numba-cuda finds no GPU here; install what requirements-gpu.txt lists on a machine '
            'with an NVIDIA GPU and its driver, or simulate on the CPU.'
        )
    return cuda


@cache
def _kernel() -> ModuleType:
    """Return the kernel of all effects."""
    return load(kernel_source(EFFECTS, FORM))


def advance_many(
    states: ArrayLike,
    fleet: Fleet,
    duties: ArrayLike,
    winds: ArrayLike,
    dt: float,
    steps: int,
) -> NDArray[np.float64]:
    """
    Return the states after `steps` classical Runge-Kutta steps under constant commands.

    Parameters
    ----------
    states : array_like, shape (V, N)
        Layout of `lta_sim.state`, SI.
    fleet : Fleet
        The vehicles.
    duties : array_like, shape (V, 4)
        Commanded duty of each rotor, -1 to 1.
    winds : array_like, shape (V, 3)
        Steady uniform velocity of the air in `map`. [m/s]
    dt : float
        Length of a step. [s]
    steps : int
        Number of steps.

    Returns
    -------
    ndarray, shape (V, N)
        The later states, their quaternions normalised after each step.

    Raises
    ------
    BadInput
        If there is no GPU or no numba-cuda.
    ValueError
        If an array has the wrong shape.

    """
    cuda = _cuda()
    fixed, state = columns(states, fleet, duties, winds)
    count = len(fleet)
    there = cuda.to_device(state.ravel())
    blocks = -(-count // THREADS)
    _kernel().advance_many[blocks, THREADS](
        cuda.to_device(fixed.ravel()), there, count, float(dt), int(steps)
    )
    return np.ascontiguousarray(there.copy_to_host().reshape(state.shape).T)
