"""Compute digests of the effect library and the vehicle to which a score applies."""

import ast
from collections.abc import Callable, Mapping
import hashlib
import json
from typing import Any, Final

from lta_config.compilation.extract import SourceExtract
from lta_config.files import find_file
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    Effect,
    InertiaEffect,
    MeasurementEffect,
)
import yaml

LENGTH: Final = 12


def _hash_text(text: str) -> str:
    """Return the first 12 digits of the SHA-256."""
    return hashlib.sha256(text.encode()).hexdigest()[:LENGTH]


def _list_equations(effect: Effect) -> list[Callable[..., Any]]:
    """Return the functions that define an effect."""
    if isinstance(effect, MeasurementEffect):
        return [effect.reading]
    if isinstance(effect, BodyEffect):
        return [effect.change]
    if isinstance(effect, InertiaEffect):
        return [effect.diagonal]
    if isinstance(effect, ActuatorEffect):
        return [effect.output, effect.rate]
    return [effect.air if isinstance(effect, AirEffect) else effect.wrench, effect.rate]


def _normalize_source(text: str) -> str:
    """Return source without docstrings, layout and the names of its functions."""
    # Parsing and unparsing also removes comments and formatting
    tree = ast.parse(text)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    # Numbers in the order of definition, so that a renamed function leaves the digest unchanged
    names = {node.name: f'function_{k}' for k, node in enumerate(functions)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            node.id = names.get(node.id, node.id)
        if not isinstance(node, ast.FunctionDef):
            continue
        node.name = names[node.name]
        if isinstance(node.body[0], ast.Expr):
            # A function must have at least one statement
            node.body = node.body[1:] or [ast.Pass()]
    return ast.unparse(tree)


def compute_registry_digest(effects: Mapping[str, Effect] = EFFECTS) -> str:
    """Return a digest of the parameters and equations of all effects."""
    described = []
    for name, effect in effects.items():
        extract = SourceExtract()
        for function in _list_equations(effect):
            extract.add_function(function, name)
        # The source text of a parameter is documentation and does not count
        numbers = [[p.name, p.unit, p.null, p.low, p.high, p.spread] for p in effect.parameters]
        described.append([name, numbers, _normalize_source(extract.render_pieces(''))])
    return _hash_text(json.dumps(described))


def vehicle_digest(name: str) -> str:
    """
    Return a digest of the values in a vehicle file; comments do not change it.

    Controller and photodiodes are left out, since discovery does not use them.
    """
    content = yaml.safe_load(find_file('vehicle', name).read_text(encoding='utf-8'))
    content.pop('control', None)
    content.get('sensors', {}).pop('diodes', None)
    return _hash_text(json.dumps(content, sort_keys=True))
