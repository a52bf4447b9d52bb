"""
Put values into a vehicle file without disturbing the rest of it: its comments, order and layout.

YAML itself tells where each value of a text stands; only that is replaced, and what is new goes
behind the last of its neighbours. A text that takes it otherwise (anchors, tags) is written anew
as a whole: what it says is never in doubt, only how it looks.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from lta_config.errors import BadInput
import yaml

WIDE: Final = 10**6  # no line of a value is folded

Way = Sequence[str]


def _parse_text(text: str) -> Any:  # noqa: ANN401 - as YAML has it
    """Return what a text says."""
    return yaml.load(text, Loader=yaml.CSafeLoader)


def format_inline(value: Any) -> str:  # noqa: ANN401 - as YAML has it
    """Return a value as a file has it on one line."""
    text = yaml.safe_dump(
        value, default_flow_style=True, sort_keys=False, width=WIDE, allow_unicode=True
    )
    return text.removesuffix('\n').removesuffix('\n...')


def set_value(text: str, way: Way, value: Any) -> str:  # noqa: ANN401 - as YAML has it
    """
    Return a file's text with a value at a place, put there or replaced.

    Parameters
    ----------
    text : str
        A mapping in YAML.
    way : sequence of str
        The keys that lead to the place; those that are missing are made.
    value : Any
        What is to stand there.

    Raises
    ------
    BadInput
        If the text is no mapping, or the way leads through something that is none.

    """
    content = _parse_text(text)
    wanted = _set_in_content(content, list(way), value)
    node = yaml.compose(text, Loader=yaml.CSafeLoader)
    try:
        new = _set_in_text(text, node, list(way), value)
        if _parse_text(new) == wanted:
            return new
    except (yaml.YAMLError, ValueError):
        pass
    return yaml.safe_dump(wanted, sort_keys=False, width=WIDE, allow_unicode=True)


def _set_in_content(content: Any, way: list[str], value: Any) -> Any:  # noqa: ANN401 - as YAML has it
    """Return what a file says with a value at a place."""
    if not way:
        return value
    if content is None:
        content = {}
    if not isinstance(content, Mapping):
        raise BadInput(f"'{way[0]}' cannot be set in the vehicle file: it is within a value.")
    return {**content, way[0]: _set_in_content(content.get(way[0]), way[1:], value)}


def _set_in_text(text: str, node: Any, way: list[str], value: Any) -> str:  # noqa: ANN401 - a node
    """Return the text with the value at its place; ValueError where it has none."""
    if not way or (isinstance(node, yaml.ScalarNode) and not node.value.strip('~')):
        for key in reversed(way):
            value = {key: value}
        said = format_inline(value)
        begin, end = node.start_mark.index, node.end_mark.index
        return text[:begin] + (said if end > begin else f' {said}') + text[end:]
    if not isinstance(node, yaml.MappingNode):
        raise ValueError('no mapping')
    for key, below in node.value:
        if key.value == way[0]:
            return _set_in_text(text, below, way[1:], value)
    for key in reversed(way[1:]):
        value = {key: value}
    return _append_line(text, node, f'{way[0]}: {format_inline(value)}')


def _append_line(text: str, node: yaml.MappingNode, line: str) -> str:
    """Return the text with a line at the end of a mapping."""
    if node.flow_style:
        end = node.end_mark.index - 1
        before = text[:end].rstrip()
        return before + (', ' if node.value else '') + line + text[end:]
    if not node.value:
        raise ValueError('an empty mapping in blocks')
    column = node.value[0][0].start_mark.column
    end = text.find('\n', _find_end(node))
    end = len(text) if end < 0 else end
    return f'{text[:end]}\n{" " * column}{line}{text[end:]}'


def _find_end(node: yaml.Node) -> int:
    """Return where the last value in a node ends, without the comments behind it."""
    if isinstance(node, yaml.MappingNode | yaml.SequenceNode) and not node.flow_style:
        last = node.value[-1]
        return _find_end(last[1] if isinstance(last, tuple) else last)
    end: int = node.end_mark.index
    return end
