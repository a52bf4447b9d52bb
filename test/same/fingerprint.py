# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What the last bits of a result depend on besides the code: the processor and the libraries.

Compiled loops use the vector units of the processor they run on, so another processor may round
otherwise. Hashes and figures of two machines can be compared only where this text is the same.
"""

from importlib.metadata import version
import os
from pathlib import Path
import platform

VECTORS = ('avx', 'fma', 'sse', 'asimd')
LIBRARIES = ('numpy', 'scipy', 'numba', 'llvmlite', 'pydantic')


def read_processor() -> tuple[str, str]:
    """Return name and sorted features of the first processor; without /proc only the machine's."""
    try:
        text = Path('/proc/cpuinfo').read_text()
    except OSError:
        return platform.machine(), ''
    facts = dict(line.split(':', 1) for line in text.split('\n\n')[0].splitlines() if ':' in line)
    facts = {key.strip(): value.strip() for key, value in facts.items()}
    features = facts.get('flags') or facts.get('Features', '')
    vectors = sorted(one for one in features.split() if one.startswith(VECTORS))
    return facts.get('model name', platform.machine()), ' '.join(vectors)


def describe_machine() -> str:
    """Return one line for each fact that can change the last bits of a result."""
    name, vectors = read_processor()
    facts = {
        'processor': name,
        'vector units': vectors,
        'python': platform.python_version(),
        'libc': ' '.join(platform.libc_ver()),
        # Chooses the routines of the linear algebra by another processor than this one
        'OPENBLAS_CORETYPE': os.environ.get('OPENBLAS_CORETYPE', ''),
        **{one: version(one) for one in LIBRARIES},
    }
    return ''.join(f'{key}: {value}\n' for key, value in facts.items())
