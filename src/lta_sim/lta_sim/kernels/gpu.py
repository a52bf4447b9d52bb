"""
Advance many vehicles on a GPU, one per thread, compiled with numba-cuda.

Needs an NVIDIA GPU and the packages in requirements-gpu.txt. Uses double precision; the GPU may
fuse multiplications and additions, so results differ from the CPU's in the last bits.
"""

from functools import cache
from importlib import import_module
from string import Template
from types import ModuleType

from lta_config.compilation.kernel_cache import load_kernel
from lta_config.errors import BadInput
from lta_model.effects import EFFECTS
from lta_sim.kernels.compose import KernelTarget, render_kernel_source
from lta_sim.kernels.thread import THREAD_MODEL, ThreadAccess
from lta_sim.kernels.vehicle_batch import select_used_numbers, VehicleBatch
import numpy as np
from numpy.typing import ArrayLike, NDArray

# Few threads per block: each holds a whole vehicle, and they share the registers.
THREADS = 64

GPU_ENTRIES = f'''{THREAD_MODEL}

$ENTRY
def advance_many(fixed, command_rows, surroundings_rows, state_rows, dt, steps):
    """Advance vehicle i, a row of the arrays, in thread i."""
    i = cuda.grid(1)
    if i < state_rows.shape[0]:
        row, state, command, surroundings = fixed[i], $state, $command, $surroundings
        for _ in range(steps):
            a = rates(state, row, command, surroundings)
            b = rates(ahead(state, a, 0.5 * dt), row, command, surroundings)
            c = rates(ahead(state, b, 0.5 * dt), row, command, surroundings)
            d = rates(ahead(state, c, dt), row, command, surroundings)
            state = normalised(ahead(state, mean(a, b, c, d), dt))
$stores
'''

GPU_TARGET = KernelTarget(
    'from numba import cuda\n',
    '@cuda.jit(device=True)',
    '@cuda.jit',
    ThreadAccess(),
    Template(GPU_ENTRIES),
)


def require_cuda() -> ModuleType:
    """Return numba's CUDA target; raise BadInput if numba-cuda or a usable GPU is missing."""
    # numba-cuda 0.30 still uses a function that numpy 2.5 removed.
    vars(np).setdefault('row_stack', np.vstack)
    try:
        cuda = import_module('numba.cuda')
    except ImportError as error:
        raise BadInput(
            f'Cannot import numba-cuda ({error}); install the packages in '
            'requirements-gpu.txt, or simulate on the CPU.'
        ) from None
    if not cuda.is_available():
        raise BadInput(
            'numba-cuda finds no GPU; use a machine with an NVIDIA GPU, its driver and '
            'the packages in requirements-gpu.txt, or simulate on the CPU.'
        )
    return cuda


@cache
def _load_kernel(names: tuple[str, ...]) -> ModuleType:
    """Load the kernel of the given effects only, because registers are scarce."""
    return load_kernel(render_kernel_source({name: EFFECTS[name] for name in names}, GPU_TARGET))


def advance_many(
    states: ArrayLike,
    vehicles: VehicleBatch,
    commands: ArrayLike,
    surroundings: ArrayLike,
    dt: float,
    steps: int,
) -> NDArray[np.float64]:
    """
    Return the states after `steps` classical Runge-Kutta steps under constant commands.

    Parameters and shapes as for `batch.advance_many`.

    Raises
    ------
    BadInput
        If there is no GPU or no numba-cuda.
    ValueError
        If an array has the wrong shape.

    """
    cuda = require_cuda()
    used = select_used_numbers(states, vehicles, commands, surroundings)
    *own, commands, around = used.fixed
    # Column-major, so that neighbouring threads read neighbouring numbers
    fixed, ordered, met, there = (
        cuda.to_device(np.asfortranarray(part))
        for part in (np.hstack(own), commands, around, used.state)
    )
    # Rounded up; surplus threads of the last block do nothing
    blocks = -(-len(vehicles) // THREADS)
    _load_kernel(used.names).advance_many[blocks, THREADS](
        fixed, ordered, met, there, float(dt), int(steps)
    )
    return used.merge_states(there.copy_to_host())
