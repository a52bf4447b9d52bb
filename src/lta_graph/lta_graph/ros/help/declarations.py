"""
Read from the source of a node what it declares, without creating it: a node may open a device.

The settings models are found by the calls that declare them, and the topics by the calls that
create publishers and subscriptions, with the topic table.
"""

import ast
from collections.abc import Iterable, Iterator
import inspect
from types import ModuleType

from lta_config.topics import load_topic_table
from pydantic import BaseModel

SUBSCRIBE = ('subscribe_topic', 'subscribe_raw')


def parse_module(module: ModuleType) -> ast.Module:
    """Return the syntax tree of a module; empty if it has no source, as code on a command line."""
    try:
        return ast.parse(inspect.getsource(module))
    except (OSError, TypeError):
        return ast.parse('')


def find_settings_models(module: ModuleType, tree: ast.AST) -> Iterator[type[BaseModel]]:
    """Yield the models in calls of `NodeParameters(node, MODEL, ...)`."""
    for call in iterate_calls(tree, 'NodeParameters'):
        # The second argument is the settings model
        if isinstance(model := call.args[1], ast.Name):
            yield getattr(module, model.id)


def find_topics(tree: ast.AST) -> tuple[list[str], list[str], bool]:
    """Return the topics that a node publishes and reads, and whether there may be others."""
    table = load_topic_table()
    outputs = list(iterate_calls(tree, 'create_output'))
    outward = set(iterate_texts(iterate_calls(tree, 'create_output', 'create_publisher')))
    published = {'/diagnostics'} | outward & table.topics.keys()
    for role in iterate_texts(iterate_calls(tree, 'published_by')):
        published.update(table.published_by(role))
    read = {
        name
        for role in iterate_texts(iterate_calls(tree, 'read_by'))
        for name in table.read_by(role)
    }
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        # Some subscribe in a loop over names
        if any(iterate_calls(function, *SUBSCRIBE)):
            values = {node.value for node in ast.walk(function) if isinstance(node, ast.Constant)}
            read |= {name for name in table.topics.keys() - outward if name in values}
    open_ended = any(not isinstance(call.args[0], ast.Constant) for call in outputs) or any(
        iterate_calls(tree, 'create_subscription', 'subscribe', '_subscribe_topic')
    )
    in_order = list(table.topics)
    return (
        [name for name in in_order if name in published],
        [name for name in in_order if name in read],
        open_ended,
    )


def iterate_calls(tree: ast.AST, *names: str) -> Iterator[ast.Call]:
    """Yield the calls of functions or methods with these names."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            called = getattr(node.func, 'attr', getattr(node.func, 'id', ''))
            if called in names:
                yield node


def iterate_texts(calls: Iterable[ast.Call]) -> Iterator[str]:
    """Yield the arguments of calls that are literal texts."""
    for call in calls:
        for argument in call.args:
            if isinstance(argument, ast.Constant):
                yield str(argument.value)
