# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A kernel on disk is the one that its effects describe, whoever wrote it and whenever."""

from concurrent.futures import ThreadPoolExecutor
import os
import subprocess
import sys
import textwrap

from lta_config.compilation.kernel_cache import is_cached, load_kernel, store_kernel
import pytest

TINY = 'def answer():\n    return 42\n'
COMPILED = f'from numba import njit\n\n\n@njit(cache=True)\n{TINY}'

EFFECT = '''
    """A push along x, from another package."""

    from lta_model.effects.protocol import EffectParameter, WrenchEffect


    def compute_wrench(p, memory, motion, thrust):
        """Return the push."""
        (push,) = p
        return ({expression}, 0.0, 0.0, 0.0, 0.0, 0.0)


    PARAMETERS = (EffectParameter('push', 'N', 0.0, -9.0, 9.0, 0.1, 'test'),)
    EFFECT = WrenchEffect('side_push', PARAMETERS, compute_wrench, ('push',))
'''

SCRIPT = """
    from lta_model.effects import initial_memory
    from lta_sim.kernels.kernel import effect_wrenches
    from lta_model.model import VehicleModel
    from lta_model.state import pack_state
    import numpy as np
    import sys

    still = {'mass': 2.0, 'cg': np.zeros(3), 'inertia': np.eye(3)}
    model = VehicleModel.build({'side_push': {'push': 3.0}}, **still)
    wrench = effect_wrenches(pack_state(memory=initial_memory()), model, np.zeros(4))['side_push']
    sys.stdout.write(str(float(wrench[0])))
"""


@pytest.mark.long  # compiles the whole kernel twice
def test_an_edited_effect_never_runs_stale(tmp_path):
    package = tmp_path / 'site'
    information = package / 'side_push-1.dist-info'
    information.mkdir(parents=True)
    (information / 'METADATA').write_text('Metadata-Version: 2.1\nName: side-push\nVersion: 1\n')
    (information / 'entry_points.txt').write_text('[lta.effects]\nside_push = side_push:EFFECT\n')
    environment = os.environ | {
        'PYTHONPATH': os.pathsep.join([str(package), *filter(None, sys.path)]),
        'XDG_CACHE_HOME': str(tmp_path / 'cache'),
    }

    def push(expression):
        (package / 'side_push.py').write_text(
            textwrap.dedent(EFFECT.format(expression=expression)).lstrip()
        )
        result = subprocess.run(
            [sys.executable, '-c', textwrap.dedent(SCRIPT)],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        return float(result.stdout)

    assert push('1.0 * push') == 3.0
    assert push('5.0 * push') == 15.0
    assert len(list((tmp_path / 'cache' / 'lta' / 'kernels').iterdir())) == 2


def test_each_text_has_its_folder(tmp_path):
    one, two = store_kernel(TINY, tmp_path), store_kernel(TINY.replace('42', '43'), tmp_path)
    assert one.parent != two.parent
    assert store_kernel(TINY, tmp_path) == one


def test_it_is_known_whether_a_kernel_has_to_be_compiled(tmp_path):
    kernel = load_kernel(COMPILED, tmp_path)
    assert not is_cached(COMPILED, tmp_path)
    assert kernel.answer() == 42
    assert is_cached(COMPILED, tmp_path)
    assert not is_cached(COMPILED.replace('42', '43'), tmp_path)


def test_a_broken_file_is_mended(tmp_path):
    path = store_kernel(TINY, tmp_path)
    path.write_text(TINY[:10])
    assert load_kernel(TINY, tmp_path).answer() == 42


def test_many_writers_leave_one_whole_file(tmp_path):
    with ThreadPoolExecutor(16) as pool:
        paths = set(pool.map(lambda _: store_kernel(TINY, tmp_path), range(64)))
    (path,) = paths
    assert path.read_text() == TINY
    assert [item.name for item in path.parent.iterdir()] == ['kernel.py']


@pytest.mark.parametrize('place', ['file', 'file/below'])
def test_an_unwritable_cache_is_done_without(tmp_path, place):
    (tmp_path / 'file').write_text('in the way')
    module = load_kernel(TINY.replace('42', '44'), tmp_path / place)
    assert module.answer() == 44
    assert (tmp_path / 'file').read_text() == 'in the way'
