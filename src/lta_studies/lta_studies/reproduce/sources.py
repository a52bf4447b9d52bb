"""
Hash the files that a row depends on, so that a change triggers a new study.

These are all files of the core packages, where effects and control laws are loaded at run time,
all configuration files except those of other rows, and whatever else the row's study imports,
directly or indirectly.
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
DATA_PATTERNS: Final = ('*.yaml', '*.json')
ROW_FOLDER: Final = 'paper'  # folder with one file per row
STORED_FORMAT_MODULE: Final = 'lta_studies.reproduce.study_result'  # defines the stored format


def hash_sources(name: str) -> str:
    """Return a hash that changes whenever the results of a row may change."""
    digest = hashlib.sha256()
    for path in iterate_sources(name):
        # Folder and name rather than the full path, which differs between machines
        digest.update(f'{path.parent.name}/{path.name}'.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def iterate_sources(name: str) -> Iterator[Path]:
    """Yield the files that a row depends on, in a reproducible order."""
    for pattern in DATA_PATTERNS:
        for path in sorted(share_folder().rglob(pattern)):
            if path.parent.name != ROW_FOLDER or path.stem == name:
                yield path
    for package in CORES:
        yield from sorted(package_folder(package).rglob('*.py'))
    study = f'lta_studies.reproduce.studies.{name}'
    yield from sorted(trace_imports(study) | trace_imports(STORED_FORMAT_MODULE))


def trace_imports(module: str) -> set[Path]:
    """Return the files outside the cores that a module imports, directly or indirectly."""
    paths: set[Path] = set()
    todo = [module]
    while todo:
        path = find_module_file(todo.pop())
        if path is not None and path not in paths:
            paths.add(path)
            todo += parse_imports(path)
    return paths


@cache
def parse_imports(path: Path) -> tuple[str, ...]:
    """Return every module that a file may import, including nested imports."""
    names = []
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            # An imported name may itself be a module.
            names += [node.module, *(f'{node.module}.{alias.name}' for alias in node.names)]
    return tuple(names)


@cache
def find_module_file(module: str) -> Path | None:
    """Return the file of a module outside the cores, or None."""
    package, *below = module.split('.')
    # Cores are hashed as a whole; packages of others are not hashed.
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
