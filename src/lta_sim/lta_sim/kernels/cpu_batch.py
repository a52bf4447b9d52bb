"""
Advance many vehicles on the CPU, with SIMD instructions and on all cores.

Each state equals that of the scalar kernel to the last bit: the compiler may run the same
arithmetic for several vehicles at once, but may not reorder it.
"""

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from string import Template
from types import ModuleType

from lta_config.compilation.compiler import INNER_OPTIONS
from lta_config.compilation.kernel_cache import load_kernel
from lta_config.machine import count_cores
from lta_model.effects import EFFECTS
from lta_sim.kernels.columns import ColumnAccess
from lta_sim.kernels.compose import KernelTarget, render_kernel_source
from lta_sim.kernels.vehicle_batch import pack_blocks, select_used_numbers, VehicleBatch
import numpy as np
from numpy.typing import ArrayLike, NDArray

WIDTH = 16  # vehicles of a block, such that its working numbers stay in the caches
BATCH_ENTRIES = '''
WIDTH = $width


$loops


$LOOP
def rates(block):
    """Write d/dt of the states of a block."""
$calls


$ENTRY
def advance_blocks(blocks, dt, steps):
    """Advance blocks of WIDTH vehicles; a row of `blocks` holds constants, then states."""
    state, begin, rate = $state * WIDTH, $begin * WIDTH, $rate * WIDTH
    first, middle, size = $first * WIDTH, $middle * WIDTH, $size * WIDTH
    half = 0.5 * dt
    # From the begin of a cache line, as a vector across two takes twice as long
    space = np.zeros($rows * WIDTH + 7)
    skipped = -(space.ctypes.data // 8) % 8
    block = space[skipped : skipped + $rows * WIDTH]
    for given in blocks:
        block[: $inputs * WIDTH] = given
        for _ in range(steps):
            for k in range(size):
                block[begin + k] = block[state + k]
            rates(block)
            for k in range(size):
                block[first + k] = block[rate + k]
                block[state + k] = block[begin + k] + half * block[rate + k]
            rates(block)
            for k in range(size):
                block[middle + k] = block[rate + k]
                block[state + k] = block[begin + k] + half * block[rate + k]
            rates(block)
            for k in range(size):
                block[middle + k] = block[middle + k] + block[rate + k]
                block[state + k] = block[begin + k] + dt * block[rate + k]
            rates(block)
            for k in range(size):
                mean = (block[first + k] + 2.0 * block[middle + k] + block[rate + k]) / 6.0
                block[state + k] = block[begin + k] + dt * mean
            for i in range(WIDTH):
                x, y = block[state + 3 * WIDTH + i], block[state + 4 * WIDTH + i]
                z, w = block[state + 5 * WIDTH + i], block[state + 6 * WIDTH + i]
                n = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
                block[state + 3 * WIDTH + i], block[state + 4 * WIDTH + i] = x * n, y * n
                block[state + 5 * WIDTH + i], block[state + 6 * WIDTH + i] = z * n, w * n
        given[state:] = block[state : state + size]
'''


def render_batch_source(
    names: Iterable[str], zeros: frozenset[int], rotors: int, width: int = WIDTH
) -> str:
    """
    Return the source of the kernel of some effects.

    Parameters
    ----------
    names : iterable of str
        Effects, in registry order.
    zeros : frozenset of int
        Places of the parameters that are 0 in all vehicles.
    rotors : int
        Number of rotors; those beyond have no thrust.
    width : int
        Vehicles of a block.

    """
    form = KernelTarget(
        'from numba import njit\nimport numpy as np\n',
        f'@njit({INNER_OPTIONS}, forceinline=True)',
        # No fastmath, which would reorder arithmetic; nogil lets the thread pool run in parallel
        "@njit(error_model='numpy', fastmath=False, nogil=True, cache=True)",
        ColumnAccess('WIDTH', zeros, rotors),
        Template(Template(BATCH_ENTRIES).safe_substitute(width=width)),
    )
    return render_kernel_source({name: EFFECTS[name] for name in names}, form)


@cache
def _load_kernel(
    names: tuple[str, ...], zeros: frozenset[int], rotors: int, width: int
) -> ModuleType:
    """Load the kernel of a batch."""
    # One of all effects takes three times as long to compile, so there is none to begin with
    return load_kernel(render_batch_source(names, zeros, rotors, width))


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

    The first call for a set of effects compiles a kernel that has these only. It flies even one
    vehicle faster than `kernel.advance`, whose kernel has all effects.

    Parameters
    ----------
    states : array_like, shape (V, N)
        Layout of `lta_model.state`, SI.
    commands : array_like, shape (V, up to COMMAND)
        Duties and the position of the moving mass.
    surroundings : array_like, shape (V, up to SURROUNDINGS)
        Wind, noise, irradiance, voltage.
    dt : float
        Length of a step; below about 2.7 times the shortest time constant. [s]

    Returns
    -------
    ndarray, shape (V, N)
        New states, equal to those of `kernel.advance` to the last bit.

    Raises
    ------
    ValueError
        If an array has the wrong shape.

    """
    used = select_used_numbers(states, vehicles, commands, surroundings)
    count, size = used.state.shape
    # One vehicle would be computed as many times as a block is wide
    kernel = _load_kernel(used.names, used.zeros, used.rotors, WIDTH if count > 1 else 1)
    packed = pack_blocks((*used.fixed, used.state), kernel.WIDTH)
    blocks = packed.reshape(len(packed), -1)
    cores = count_cores()
    # More pieces than cores, so that a delayed core does not hold up the rest.
    pieces = min(len(blocks), 4 * cores)
    with ThreadPoolExecutor(cores) as pool:
        done = pool.map(
            lambda part: kernel.advance_blocks(part, float(dt), int(steps)),
            np.array_split(blocks, pieces),
        )
        # Raises exceptions of the workers
        list(done)
    # Drop the padding of the last block
    return used.merge_states(packed[:, -size:].swapaxes(1, 2).reshape(-1, size)[:count])
