"""
The kernel of the GPU is the CPU's, and whoever has no GPU is told what to do.

The kernel runs here under numba's CUDA simulator, which is chosen when numba is first imported and
so needs a process of its own.
"""

from importlib.util import find_spec
import os
import subprocess
import sys
import textwrap

from lta_config.errors import BadInput
from lta_sim.kernels import gpu, kernel
from lta_sim.kernels.vehicle_batch import VehicleBatch
import numpy as np
import pytest

from . import flat_balloon as balloon

needs_cuda = pytest.mark.skipif(
    find_spec('numba.cuda') is None, reason='this numba needs numba-cuda (requirements-gpu.txt)'
)

SIMULATED = """
    from pathlib import Path
    import sys

    from lta_sim.kernels import gpu
    from lta_sim.kernels.vehicle_batch import VehicleBatch
    import numpy as np

    folder, gpu.THREADS = Path(sys.argv[1]), 2
    states, duties, winds, *fleet = (np.load(folder / f'{k}.npy') for k in range(7))
    later = gpu.advance_many(states, VehicleBatch(*fleet), duties, winds, 2e-3, 5)
    np.save(folder / 'later.npy', later)
"""


def in_process(script, *arguments, **environment):
    """Run a script in a process of its own and return it."""
    return subprocess.run(
        [sys.executable, '-W', 'error', '-c', textwrap.dedent(script), *map(str, arguments)],
        env=os.environ | {'PYTHONPATH': os.pathsep.join(filter(None, sys.path))} | environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def flights():
    """Return three vehicles, one of them with its foot in the floor, and how they fly."""
    generator = np.random.default_rng(2)
    given = [
        balloon.EVERYTHING | {'motor_lag': {'up': 0.05 * k, 'down': 0.1 * k}} for k in range(3)
    ]
    models = [balloon.model(one, generator.normal(0.0, 0.03, 3)) for one in given]
    starts = [balloon.anywhere(generator, (height, height)) for height in (1.0, -0.5, 2.0)]
    return models, *(np.array(column) for column in zip(*starts, strict=True))


@needs_cuda
def test_each_thread_flies_its_vehicle_as_the_cpu_does(flights, tmp_path):
    models, states, duties, winds = flights
    fleet = VehicleBatch.from_models(models)
    arrays = (states, duties, winds, fleet.parameters, fleet.on, fleet.body, fleet.inverse)
    for k, array in enumerate(arrays):
        np.save(tmp_path / f'{k}.npy', array)
    done = in_process(SIMULATED, tmp_path, NUMBA_ENABLE_CUDASIM='1')
    assert done.returncode == 0, done.stderr
    expected = [
        kernel.advance(state, model, duty, wind, 2e-3, 5)
        for state, model, duty, wind in zip(states, models, duties, winds, strict=True)
    ]
    np.testing.assert_array_equal(np.load(tmp_path / 'later.npy'), expected)


@needs_cuda
def test_without_a_gpu_it_says_what_to_do():
    script = """
        from lta_config.errors import BadInput
        from lta_sim.kernels.gpu import advance_many
        try:
            advance_many([], None, [], [], 2e-3, 1)
        except BadInput as refusal:
            import sys
            sys.stdout.write(str(refusal))
    """
    done = in_process(script, NUMBA_ENABLE_CUDASIM='0', CUDA_VISIBLE_DEVICES='-1')
    assert done.stdout == (
        'numba-cuda finds no GPU; use a machine with an NVIDIA GPU, its driver and the packages '
        'in requirements-gpu.txt, or simulate on the CPU.'
    ), done.stderr


def test_without_numba_cuda_it_says_what_to_do(flights, monkeypatch):
    models, states, duties, winds = flights
    monkeypatch.setitem(sys.modules, 'numba.cuda', None)
    with pytest.raises(BadInput, match=r'Cannot import numba-cuda .*; install the packages'):
        gpu.advance_many(states, VehicleBatch.from_models(models), duties, winds, 2e-3, 1)
