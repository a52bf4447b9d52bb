# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Cache compiled kernels on disk, each in a folder named by the hash of its source.

numba's own cache checks one file only and misses an edit in a module that the kernel imports. Here
a kernel is one self-contained text and its hash names the folder, so a compiled kernel is reused
only if every line is the same.
"""

import atexit
import hashlib
import importlib.util
import os
from pathlib import Path
import shutil
import sys
import tempfile
from types import ModuleType

from lta_config.machine import find_cache_folder

# Modification time of all kernels [s]: numba takes a changed time for a changed source
KERNEL_TIME = 1_000_000_000


def cache_root() -> Path:
    """Return the folder of all kernels."""
    return find_cache_folder('kernels')


def kernel_folder(source: str, root: Path) -> Path:
    """Return the folder of a kernel, named by its text."""
    # 64 bits of the hash are enough to tell kernels apart
    return root / hashlib.sha256(source.encode()).hexdigest()[:16]


def is_cached(source: str, root: Path | None = None) -> bool:
    """Return whether a compiled kernel is on disk; compiling it takes long."""
    # numba writes an index .nbi for each compiled function
    return any(kernel_folder(source, root or cache_root()).glob('__pycache__/*.nbi'))


def store_kernel(source: str, root: Path) -> Path:
    """
    Write a kernel to its folder unless it is there, safely with concurrent processes.

    Parameters
    ----------
    root : Path
        Folder of all kernels.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    OSError
        If the folder is not writable; numba writes there too.

    """
    folder = kernel_folder(source, root)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / 'kernel.py'
    if not os.access(folder, os.W_OK):
        raise PermissionError(f'{folder} cannot be written.')
    if path.exists() and path.read_text(encoding='utf-8') == source:
        return path
    with tempfile.NamedTemporaryFile('w', dir=folder, suffix='.tmp', delete=False) as file:
        file.write(source)
    temporary = Path(file.name)
    os.utime(temporary, (KERNEL_TIME, KERNEL_TIME))
    # Atomic: another process sees the whole file or none
    temporary.replace(path)
    return path


def load_kernel(source: str, root: Path | None = None) -> ModuleType:
    """
    Return a kernel as a module; use a temporary folder if the cache is not writable.

    Parameters
    ----------
    root : Path, optional
        Folder of all kernels; `cache_root()` by default.

    Returns
    -------
    module
        The kernel; its functions compile on their first calls.

    """
    try:
        path = store_kernel(source, root or cache_root())
    except OSError:
        folder = tempfile.mkdtemp(prefix='lta-kernels-')
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        path = store_kernel(source, Path(folder))
    name = f'lta_kernel_{path.parent.name}'
    specification = importlib.util.spec_from_file_location(name, path)
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    # numba looks up the functions of a cached kernel by the name of their module
    sys.modules[name] = module
    specification.loader.exec_module(module)
    return module
