"""
The text of `--help` of a node: its task, its parameters and its topics.

They are read from the source of the node, without creating it: a node may open a device. The
settings models are found by the calls that declare them, and the topics by the calls that create
publishers and subscriptions, with the topic table.
"""

import ast
from collections.abc import Iterable, Iterator, Sequence
import inspect
from pathlib import Path
import sys
from types import ModuleType
from typing import Any

from lta_config.settings import format_bounds
from lta_config.topics import load_topic_table
from lta_graph.ros.node import GraphNode, GraphSettings
from lta_graph.ros.parameters import iterate_fields
from pydantic import BaseModel
from pydantic.fields import FieldInfo

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


HELP = ('-h', '--help')


def asks_for_help(words: Sequence[str]) -> bool:
    """Return whether a command line asks for help, before or after `--ros-args`."""
    return any(word in HELP for word in words[1:])


def describe_node(node_class: type[GraphNode], program: str) -> str:
    """
    Return the help of a node.

    `program` is the path of its executable, such as `install/lta_vlc/lib/lta_vlc/demodulator`.
    """
    module = sys.modules[node_class.__module__]
    tree = parse_module(module)
    package, name = Path(program).parts[-2:] if len(Path(program).parts) > 1 else ('', program)
    published, read, more = find_topics(tree)
    models: list[type[BaseModel]] = [GraphSettings, *find_settings_models(module, tree)]
    lines = [
        f'Usage: ros2 run {package} {name} --ros-args [-p PARAMETER:=VALUE] [-r FROM:=TO] ...',
        '',
        inspect.cleandoc(module.__doc__ or node_class.__doc__ or ''),
        '',
        'Parameters:',
        *(format_parameter(*leaf) for model in models for leaf in iterate_fields(model())),
        '',
        'Topics, relative to the namespace of the node:',
        *(format_topic('publishes', each) for each in published),
        *(format_topic('reads', each) for each in read),
    ]
    if more:
        lines.append('  Its parameters select among these topics, and others.')
    return '\n'.join(lines) + '\n'


def format_topic(what: str, name: str) -> str:
    """Return the line of one topic."""
    topic = load_topic_table()[name]
    return f'  {what:<9} {name} ({topic.type}): {topic.about}'


def format_parameter(name: str, info: FieldInfo, value: Any) -> str:  # noqa: ANN401 - of the parameter's type
    """Return the line of one parameter."""
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    limits = f'{format_bounds(info)} {extra.get("unit") or ""}'.strip()
    facts = [
        f'default {format_default(value)}' if format_default(value) else '',
        limits,
        'only at start' if extra.get('read_only') else '',
    ]
    text = ', '.join(fact for fact in facts if fact)
    return f'  {name}{f" ({text})" if text else ""}: {info.description or ""}'


def format_default(value: object) -> str:
    """Format a default as on the command line; empty if there is none."""
    if value in ('', None, ()):
        return ''
    if isinstance(value, tuple):
        return f'[{", ".join(str(item) for item in value)}]'
    return str(value).lower() if isinstance(value, bool) else str(value)
