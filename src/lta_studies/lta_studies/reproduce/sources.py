"""
What a row rests on, so that what has been studied is studied again after it has changed.

All files of the cores and of the configuration, those of other rows left out: effects and laws
are found there at run time. Of the packages around them, which hold far more than the paper needs,
what the row's study imports, and what that imports in turn.
"""

import ast
from collections.abc import Iterator
from functools import cache
import hashlib
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from lta_config.files import share_folder

CORES: Final = ('lta_config', 'lta_control', 'lta_energy', 'lta_model', 'lta_sim', 'lta_vlc')
DATA: Final = ('*.yaml', '*.json')
ROWS: Final = 'paper'  # folder with one file a row
KEPT: Final = 'lta_studies.reproduce.row_store'  # how a row is kept


def hash_sources(name: str) -> str:
    """Return a hash that changes when the figures of a row may."""
    found = hashlib.sha256()
    for path in iterate_sources(name):
        found.update(f'{path.parent.name}/{path.name}'.encode())
        found.update(path.read_bytes())
    return found.hexdigest()


def iterate_sources(name: str) -> Iterator[Path]:
    """Yield the files that a row rests on, in the same order everywhere."""
    for pattern in DATA:
        for path in sorted(share_folder().rglob(pattern)):
            if path.parent.name != ROWS or path.stem == name:
                yield path
    for package in CORES:
        yield from sorted(package_folder(package).rglob('*.py'))
    study = f'lta_studies.reproduce.studies.{name}'
    yield from sorted(trace_imports(study) | trace_imports(KEPT))


def trace_imports(module: str) -> set[Path]:
    """Return the files around the cores that a module is made of, by all that it imports."""
    found: set[Path] = set()
    todo = [module]
    while todo:
        path = find_module_file(todo.pop())
        if path is not None and path not in found:
            found.add(path)
            todo += parse_imports(path)
    return found


@cache
def parse_imports(path: Path) -> tuple[str, ...]:
    """Return every module that a file may import, wherever in it that stands."""
    names = []
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f'{node.module}.{alias.name}' for alias in node.names)]
    return tuple(names)


@cache
def find_module_file(module: str) -> Path | None:
    """Return the file of a module around the cores; None if it is none of them."""
    package, *below = module.split('.')
    if not package.startswith('lta_') or package in CORES:
        return None
    place = package_folder(package).joinpath(*below)
    files = (place / '__init__.py', place.with_suffix('.py'))
    return next((path for path in files if path.is_file()), None)


@cache
def package_folder(package: str) -> Path:
    """Return the folder of a package."""
    spec = find_spec(package)
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).parent
