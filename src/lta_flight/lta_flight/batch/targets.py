"""The targets of a batch flight, CPU and GPU, and its schedule."""

from dataclasses import dataclass
from typing import final

from lta_config.compilation.compiler import ENTRY, INLINE
from lta_control import allocation
from lta_model.light.ray_bundles import LAMPS, scratch_size
from lta_vlc.reading_model import FIT_SCRATCH

STEP = 2.5e-3  # s, integration step, as in `lta_sim.world`
SCRATCH = max(allocation.SCRATCH, FIT_SCRATCH)  # shared, since both are used in turn
PENCILS = scratch_size(1)


@final
@dataclass(frozen=True, slots=True)
class BatchRhythm:
    """Integration steps per control step and per range; control steps per pressure and block."""

    control: int
    range: int
    pressure: int
    light: int


@final
@dataclass(frozen=True, slots=True)
class CompileTarget:
    """A target: imports, decorator of the functions, and the source of the entry."""

    imports: str
    inline: str
    entry: str


CPU = CompileTarget(
    'from numba import njit\nimport numpy as np\n',
    INLINE,
    f'''
{ENTRY.replace('cache=True', 'nogil=True, cache=True')}
def fly_some(fixed, constants, seeds, out):
    """Fly some vehicles, a row each."""
    scratch, lights = np.empty({SCRATCH}), np.empty(({LAMPS + 1}, $diodes))
    pencils = np.empty({PENCILS})
    for i in range(seeds.shape[0]):
        fly(fixed[i], constants[i], seeds[i], scratch, lights, pencils, out[i])
''',
)
GPU = CompileTarget(
    'from numba import cuda, float64\n',
    '@cuda.jit(device=True)',
    f'''
@cuda.jit
def fly_some(fixed, constants, seeds, out):
    """Fly vehicle i in thread i."""
    i = cuda.grid(1)
    if i < seeds.shape[0]:
        scratch = cuda.local.array({SCRATCH}, float64)
        lights = cuda.local.array(({LAMPS + 1}, $diodes), float64)
        pencils = cuda.local.array({PENCILS}, float64)
        fly(fixed[i], constants[i], seeds[i], scratch, lights, pencils, out[i])
''',
)
