# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What tests may find in the process, and have to leave there: registries, environment, folder."""

import os
from pathlib import Path
import sys
from types import ModuleType
from typing import NamedTuple

Entries = list[tuple[object, int]]
# pytest's own; and of threadpoolctl, which scipy.io imports where scikit-learn has brought it
OTHERS = ('PYTEST_CURRENT_TEST', 'KMP_DUPLICATE_LIB_OK', 'KMP_INIT_AT_FORK')
_REGISTRIES: dict[str, list[str]] = {}  # by module: the names of its literal dictionaries


class State(NamedTuple):
    """The state of the process that every test shares with those after it."""

    registries: dict[str, Entries]  # by place: keys in their order, and whose values they are
    environment: dict[str, str]
    folder: Path


def state() -> State:
    """Return the present state."""
    found = {
        f'{module}.{name}': [(key, id(value)) for key, value in getattr(held, name).items()]
        for module, held in sys.modules.copy().items()  # a thread may be importing
        if module.startswith('lta_')
        for name in _registries_of(module, held)
    }
    environment = {key: text for key, text in os.environ.items() if key not in OTHERS}
    return State(found, environment, Path.cwd())


def _registries_of(module: str, held: ModuleType) -> list[str]:
    if module not in _REGISTRIES:
        _REGISTRIES[module] = [
            name
            for name, one in vars(held).copy().items()
            if name.isupper() and isinstance(one, dict)
        ]
    return _REGISTRIES[module]


def changes(before: State, after: State) -> list[str]:
    """Return what is no longer as it was; what was imported in between is new, and no change."""
    places = [
        place
        for place, entries in before.registries.items()
        if after.registries.get(place, entries) != entries
    ]
    names = before.environment.keys() | after.environment.keys()
    variables = [
        name for name in names if before.environment.get(name) != after.environment.get(name)
    ]
    moved = [str(after.folder)] if after.folder != before.folder else []
    return sorted(places) + sorted(variables) + moved
