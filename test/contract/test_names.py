# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Names in the source: classes are unique, and retired words stay out."""

import ast
from collections import defaultdict
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
# Words that said too little as names; a verb phrase, or the field's noun, takes their place.
# fmt: off
RETIRED = frozenset((
    'aloft', 'asked', 'belief', 'beside', 'blame', 'cast', 'craft', 'crew', 'displacing',
    'drawn', 'exam', 'faint', 'fitted', 'flown', 'found', 'given', 'heard', 'helm',
    'ingredients', 'judged', 'kept', 'known', 'lit', 'lived', 'lonely', 'loud', 'made',
    'marks', 'obedience', 'owed', 'passage', 'pencils', 'pushing', 'reel', 'referee', 'said',
    'sealed', 'seen', 'shown', 'spare', 'spoken', 'standing', 'staying', 'strung', 'suspicion',
    'taken', 'told', 'vessel', 'wanted', 'watched', 'written',
))
PARTICIPLES = frozenset((
    'asked', 'drawn', 'flown', 'found', 'given', 'heard', 'judged', 'kept', 'known', 'made',
    'said', 'sealed', 'shown', 'spoken', 'taught', 'told', 'wanted',
))
# fmt: on
# Arguments of commands are their options on the command line.
OPTIONS = ROOT / 'src' / 'lta_cli' / 'lta_cli' / 'verbs'


@cache
def sources() -> dict[Path, ast.Module]:
    files = [*ROOT.glob('src/lta_*/lta_*/**/*.py'), *ROOT.glob('config/lta_config/**/*.py')]
    return {path: ast.parse(path.read_text()) for path in sorted(files)}


def nodes(*kinds: type[ast.AST]):
    for path, tree in sources().items():
        for node in ast.walk(tree):
            if isinstance(node, kinds):
                yield path, node


def retired(name: str) -> bool:
    return bool(RETIRED.intersection(name.lower().split('_')))


def test_every_class_name_is_unique():
    where = defaultdict(list)
    for path, node in nodes(ast.ClassDef):
        where[node.name].append(f'{path.relative_to(ROOT)}:{node.lineno}')
    assert len(where) > 500
    assert {name: places for name, places in where.items() if len(places) > 1} == {}


def test_no_function_class_or_module_has_a_retired_word_as_its_name():
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    bad = [f'{path}:{node.lineno}: {node.name}' for path, node in nodes(*kinds)
           if retired(node.name)]  # fmt: skip
    bad += [str(path) for path in sources() if retired(path.stem) or retired(path.parent.name)]
    assert bad == []


def test_no_local_variable_is_a_past_participle():
    """A name says what a variable holds, not what happened to it."""
    bad = []
    for path, function in nodes(ast.FunctionDef, ast.AsyncFunctionDef):
        arguments = {
            item.arg
            for node in ast.walk(function)
            if isinstance(node, ast.arguments)
            for item in (*node.posonlyargs, *node.args, *node.kwonlyargs)
        }
        bad += [
            f'{path}:{node.lineno}: {node.id}'
            for node in ast.walk(function)
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
            if node.id in PARTICIPLES - arguments
        ]
    assert bad == []


def test_no_argument_is_a_retired_word():
    bad = []
    for path, node in nodes(ast.FunctionDef, ast.AsyncFunctionDef):
        if OPTIONS in path.parents:
            continue
        every = (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
        bad += [f'{path}:{item.lineno}: {item.arg}' for item in every if item.arg in RETIRED]
    assert bad == []
