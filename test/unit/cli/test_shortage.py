# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Too few open files, too little memory, and arithmetic on damaged data: what the user sees."""

import errno
import os
import resource
import subprocess
import sys

from lta_config.limits import describe_shortage
import pytest

MAIN = 'from lta_cli.command import main; main()'
FULL = OSError(errno.EMFILE, os.strerror(errno.EMFILE))
UNLIMITED = resource.RLIM_INFINITY


def run(code, *words, space=None):
    """Run Python with a limit of its address space [bytes]."""
    limit = None if space is None else lambda: resource.setrlimit(resource.RLIMIT_AS, (space,) * 2)
    # One thread: each takes address space, and a machine may have many cores
    environment = os.environ | {'OPENBLAS_NUM_THREADS': '1'}
    command = [sys.executable, '-P', '-c', code, *words]
    return subprocess.run(
        command, capture_output=True, text=True, env=environment, preexec_fn=limit, check=False
    )


def test_a_command_in_150_mb_of_memory_names_the_limit_and_the_remedy():
    # With more, OpenBLAS may end the process by itself, or never
    told = run(MAIN, 'vehicle', 'show', 'gtmab', space=150 << 20)
    assert told.returncode == 2, told.stderr[-2000:]
    assert told.stderr.startswith('The command failed with a limit of 150 MB of memory (')
    assert told.stderr.endswith(
        '); raise it with `ulimit -v 4194304`, in a new shell if that is refused.\n'
    )


@pytest.mark.parametrize(
    ('error', 'files', 'space', 'named'),
    [
        (FULL, 16, UNLIMITED, '16 open files'),
        (FULL, 4096, UNLIMITED, '4096 open files'),
        (ImportError('libx.so: cannot open shared object file'), 16, UNLIMITED, '16 open files'),
        (MemoryError(), 1024, 300 << 20, '300 MB of memory'),
        (OSError(errno.ENOMEM, ''), 1024, 300 << 20, '300 MB of memory'),
        (RuntimeError("can't start new thread"), 1024, 600 << 20, '600 MB of memory'),
        (MemoryError(), 1024, UNLIMITED, 'memory of this machine'),
        (RuntimeError('a defect'), 1024, UNLIMITED, None),
        (ValueError('a defect'), 16, 300 << 20, None),
    ],
)
def test_an_error_is_due_to_a_limit_if_it_says_so_or_the_limit_is_low(
    monkeypatch, error, files, space, named
):
    limits = {resource.RLIMIT_NOFILE: (files, files), resource.RLIMIT_AS: (space, space)}
    monkeypatch.setattr(resource, 'getrlimit', limits.get)
    text = describe_shortage(error)
    if named is None:
        assert text is None
        return
    assert named in text
    assert text.count('\n') == 0
    wrapped = ValueError('from the error above')
    wrapped.__cause__ = error
    direct = isinstance(error, MemoryError) or getattr(error, 'errno', None)
    assert (describe_shortage(wrapped) is not None) == bool(direct)


def test_arithmetic_on_damaged_data_writes_no_warning():
    code = (
        'import numpy as np; from lta_cli import app, command;'
        'app.run_command_line = lambda _: int(np.isfinite(np.mean(np.empty(0))));'
        'command.main()'
    )
    told = run(code)
    assert (told.returncode, told.stderr) == (0, '')
