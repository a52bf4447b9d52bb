# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Print the unit tests nearest to what changed against main: what `make test-fast` runs.

A changed test stands for itself, a changed module for the tests that import it. Where no test
imports a module, those count that import an importer of it, and so on. A `conftest.py` counts for
nothing: it is imported by no name.
"""

import ast
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
import subprocess
import sys
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[1]
FOLDERS: Final = ('campaigns/', 'config/', 'src/', 'test/')
Imports = Mapping[Path, frozenset[str]]


def changed(root: Path) -> list[Path]:
    """Return the Python files that differ from main, untracked ones too, deleted ones not."""

    def git(*words: str) -> list[str]:
        done = subprocess.run(['git', *words], cwd=root, capture_output=True, text=True)
        return done.stdout.splitlines()

    known = git('rev-parse', '--verify', '--quiet', 'origin/main') or ['main']
    base = git('merge-base', 'HEAD', known[0]) or ['HEAD']
    names = git('diff', '--name-only', '--diff-filter=d', base[0])
    names += git('ls-files', '--others', '--exclude-standard')
    return [root / name for name in names if name.endswith('.py') and name.startswith(FOLDERS)]


def module_of(path: Path, root: Path) -> str:
    """Return the name by which a file is imported: tests by their file's name alone."""
    parts = path.relative_to(root).with_suffix('').parts
    if parts[0] == 'test':
        return parts[-1]
    name = parts[{'src': 2, 'config': 1, 'campaigns': 0}[parts[0]] :]
    return '.'.join(name[:-1] if name[-1] == '__init__' else name)


def imports_of(path: Path, root: Path) -> Iterator[str]:
    """Yield the modules that a file imports, each with the names that it takes of it."""
    package = module_of(path, root).split('.')
    package = package if path.name == '__init__.py' else package[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) + 1 - node.level] if node.level else []
            source = '.'.join([*above, *filter(None, [node.module])])
            is_test = path.is_relative_to(root / 'test')
            source = source.rpartition('.')[2] if is_test and node.level else source
            yield source
            yield from (f'{source}.{alias.name}' for alias in node.names)


def read_imports(root: Path) -> Imports:
    """Return what each file of the sources and of the tests imports."""
    paths = (path for folder in FOLDERS for path in (root / folder).rglob('*.py'))
    kept = (path for path in paths if path.name != 'conftest.py')
    return {path: frozenset(imports_of(path, root)) for path in kept}


def nearest(path: Path, imports: Imports, root: Path) -> list[Path]:
    """Return the unit tests nearest to a file."""
    importers = defaultdict(list)
    for importer, names in imports.items():
        for name in names:
            importers[name].append(importer)
    seen, layer = {path}, [path]
    while layer:
        tests = [one for one in layer if is_unit_test(one, root)]
        if tests:
            return tests
        modules = {module_of(one, root) for one in layer}
        layer = sorted({one for name in modules for one in importers[name]} - seen)
        seen.update(layer)
    return []


def is_unit_test(path: Path, root: Path) -> bool:
    """Tell whether pytest finds unit tests in a file."""
    return path.is_relative_to(root / 'test' / 'unit') and path.name.startswith('test_')


def main() -> None:
    """Print the paths, each once."""
    imports = read_imports(ROOT)
    found = (
        test for path in changed(ROOT) if path in imports for test in nearest(path, imports, ROOT)
    )
    sys.stdout.writelines(f'{path.relative_to(ROOT)}\n' for path in dict.fromkeys(found))


if __name__ == '__main__':
    main()
