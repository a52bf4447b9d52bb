"""
Cache compiled kernels on disk, each in a folder named by the hash of its source.

numba's own cache checks one file only and misses an edit in a module that the kernel imports. Here
a kernel is one self-contained text and its hash names the folder, so a compiled kernel is reused
only if every line is the same.
"""

import atexit
from functools import cache
import gc
import hashlib
import importlib
import importlib.util
import os
from pathlib import Path
import shutil
import sys
import tempfile
from types import ModuleType
from typing import Any

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
    import_numba()
    specification.loader.exec_module(module)
    prepare_numba()
    return module


@cache
def import_numba() -> None:
    """
    Import numba, without coverage unless that measures already; call it before other imports.

    numba imports it, where it is installed, to report compiled lines: a fifth of its own import.
    """
    if 'coverage' in sys.modules:
        return
    # An entry of None makes the import fail
    sys.modules['coverage'] = None  # type: ignore[assignment]
    try:
        importlib.import_module('numba')
    finally:
        del sys.modules['coverage']


@cache
def prepare_numba() -> None:
    """Keep numba from what only makes it slow; call it before the first compiled function runs."""
    _load_without_registries()
    _prepare_compilation()


def _load_without_registries() -> None:
    """
    Load a cached function without the registries of all functions that numba can compile.

    To fill them takes as long as to load a dozen functions, and only the compiler reads them; it
    fills them itself.
    """
    from numba.core import caching, cpu
    from numba.core.runtime.nrt import rtsys

    load: Any = caching.Cache.load_overload

    def load_overload(self: Any, sig: Any, context: Any) -> Any:  # noqa: ANN401 - of numba
        # Others, such as that of a GPU, have a runtime of their own
        if type(context) is cpu.CPUContext:
            # The part of `refresh` that compiled functions need
            rtsys.initialize(context)
            context.refresh = lambda: None  # type: ignore[method-assign]
        try:
            return load(self, sig, context)
        finally:
            vars(context).pop('refresh', None)

    caching.Cache.load_overload = load_overload  # type: ignore[method-assign]


@cache
def _import_without_scipy() -> None:
    """
    Import what numba imports when it first compiles, without `scipy.linalg`.

    numba imports that only to see whether it is installed, which takes as long as numba itself.
    """
    from numba.np import linalg

    ensure_blas, linalg.ensure_blas = linalg.ensure_blas, lambda: None
    try:
        from numba.np import arraymath  # noqa: F401
    finally:
        linalg.ensure_blas = ensure_blas


def _prepare_compilation() -> None:
    """
    Let numba compile without `scipy.linalg` and without Python's garbage collector.

    That would scan numba's many live objects again and again, which took an eighth of the time.
    """
    from numba.core import event

    class Compiling(event.Listener):
        def __init__(self) -> None:
            self._depth = 0  # compiling a function compiles those that it calls
            self._collects = False

        def on_start(self, event: event.Event) -> None:
            if self._depth == 0:
                _import_without_scipy()
                self._collects = gc.isenabled()
                gc.disable()
            self._depth += 1

        def on_end(self, event: event.Event) -> None:
            self._depth -= 1
            if self._depth == 0 and self._collects:
                gc.enable()

    # numba emits this event at the start and end of each compilation
    event.register('numba:compile', Compiling())  # type: ignore[no-untyped-call]
