"""
Keep compiled kernels on disk, each in a folder named by the hash of its source.

numba's own cache looks at one file only: it does not see an edit in a file that the kernel
imports. Here the kernel is one self-contained text and its hash is the name of its folder, so that
a compiled kernel is found again exactly when every line of it is the same.
"""

import atexit
from functools import cache
import gc
import hashlib
import importlib.util
import os
from pathlib import Path
import shutil
import sys
import tempfile
from types import ModuleType

# One time for all writers, since numba takes another time for another source.
EPOCH = 1_000_000_000


def cache_root() -> Path:
    """Return the folder of all kernels, as the XDG base directory specification says."""
    base = os.environ.get('XDG_CACHE_HOME') or str(Path.home() / '.cache')
    return Path(base) / 'lta' / 'kernels'


def kernel_folder(source: str, root: Path) -> Path:
    """Return the folder of a kernel, named by its text."""
    return root / hashlib.sha256(source.encode()).hexdigest()[:16]


def is_cached(source: str, root: Path | None = None) -> bool:
    """Tell whether anything of a kernel is on disk compiled; to compile it takes long."""
    return any(kernel_folder(source, root or cache_root()).glob('__pycache__/*.nbi'))


def store_kernel(source: str, root: Path) -> Path:
    """
    Put a kernel into its folder unless it is there, safely among concurrent processes.

    Parameters
    ----------
    source : str
        Text of the kernel.
    root : Path
        Folder of all kernels.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    OSError
        If the folder cannot be written, which numba must do as well.

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
    os.utime(temporary, (EPOCH, EPOCH))
    temporary.replace(path)
    return path


def load_kernel(source: str, root: Path | None = None) -> ModuleType:
    """
    Return a kernel as a module; a temporary folder serves where the cache cannot be written.

    Parameters
    ----------
    source : str
        Text of the kernel.
    root : Path, optional
        Folder of all kernels; `cache_root()` if not given.

    Returns
    -------
    module
        The kernel, compiled on the first call of each of its functions.

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
    # numba finds the functions of a cached kernel by the name of their module.
    sys.modules[name] = module
    specification.loader.exec_module(module)
    _compile_without_collecting()
    return module


@cache
def _compile_without_collecting() -> None:
    """
    Stop Python's garbage collector while numba compiles.

    It would look again and again through what numba builds, of which little is garbage: that took
    an eighth of the time.
    """
    from numba.core import event

    class Compiling(event.Listener):
        def __init__(self) -> None:
            self._depth = 0  # a function compiles those that it calls
            self._collects = False

        def on_start(self, event: event.Event) -> None:
            if self._depth == 0:
                self._collects = gc.isenabled()
                gc.disable()
            self._depth += 1

        def on_end(self, event: event.Event) -> None:
            self._depth -= 1
            if self._depth == 0 and self._collects:
                gc.enable()

    event.register('numba:compile', Compiling())  # type: ignore[no-untyped-call]
