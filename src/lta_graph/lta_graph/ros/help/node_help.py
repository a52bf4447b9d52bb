"""The text of `--help` of a node: its task, its parameters and its topics."""

from collections.abc import Sequence
import inspect
from pathlib import Path
import sys
from typing import Any

from lta_config.settings import format_bounds
from lta_config.topics import load_topic_table
from lta_graph.ros.help.declarations import find_settings_models, find_topics, parse_module
from lta_graph.ros.node import GraphNode, GraphSettings
from lta_graph.ros.parameters import iterate_fields
from pydantic import BaseModel
from pydantic.fields import FieldInfo

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
