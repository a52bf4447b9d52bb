"""
Set values in a vehicle file, and keep its comments, order and layout.

The YAML parser gives the position of each value; only that text is replaced, and new keys are
added after the last one of their mapping. If the result does not parse to the expected content
(with anchors or tags, for example), the whole file is written anew. So only the layout is at risk.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from lta_config.errors import BadInput
import yaml

WIDE: Final = 10**6  # characters per line, so that no value is folded

Way = Sequence[str]


def _parse_yaml_text(text: str) -> Any:  # noqa: ANN401 - as YAML has it
    """Return the content of a YAML text."""
    return yaml.load(text, Loader=yaml.CSafeLoader)


def format_inline(value: Any) -> str:  # noqa: ANN401 - as YAML has it
    """Return a value as YAML on one line."""
    text = yaml.safe_dump(
        value, default_flow_style=True, sort_keys=False, width=WIDE, allow_unicode=True
    )
    # PyYAML ends a bare scalar with the document marker '...'
    return text.removesuffix('\n').removesuffix('\n...')


def set_yaml_value(text: str, way: Way, value: Any) -> str:  # noqa: ANN401 - as YAML has it
    """
    Return a file's text with a value set at a path.

    `text`: a mapping in YAML. `way`: the keys of the path; missing ones are created. `value`: the
    new value. Raise `BadInput` if the path leads through something that is not a mapping.
    """
    content = _parse_yaml_text(text)
    target = _set_in_content(content, list(way), value)
    node = yaml.compose(text, Loader=yaml.CSafeLoader)
    try:
        new = _set_in_text(text, node, list(way), value)
        # Accept the edited text only if it means what was intended
        if _parse_yaml_text(new) == target:
            return new
    except (yaml.YAMLError, ValueError):
        pass
    return yaml.safe_dump(target, sort_keys=False, width=WIDE, allow_unicode=True)


def set_yaml_block(text: str, key: str, value: Any) -> str:  # noqa: ANN401 - as YAML has it
    """Return a file's text with a block at the end in place of the one of a top-level key."""
    node = yaml.compose(text, Loader=yaml.CSafeLoader)
    for name, below in node.value if isinstance(node, yaml.MappingNode) else ():
        if name.value == key:
            end = text.find('\n', _find_value_end(below))
            text = text[: name.start_mark.index] + ('' if end < 0 else text[end + 1 :])
    # Leaves on one line each
    block = yaml.safe_dump({key: value}, default_flow_style=None, sort_keys=False, width=WIDE)
    return f'{text.rstrip()}\n{block}'


def _set_in_content(content: Any, way: list[str], value: Any) -> Any:  # noqa: ANN401 - as YAML has it
    """Return the content with a value set at a path."""
    if not way:
        return value
    if content is None:
        content = {}
    if not isinstance(content, Mapping):
        raise BadInput(
            f"'{way[0]}' cannot be set in the vehicle file, because the key above it has a value "
            'instead of keys; remove that value from the file first.'
        )
    return {**content, way[0]: _set_in_content(content.get(way[0]), way[1:], value)}


def _set_in_text(text: str, node: Any, way: list[str], value: Any) -> str:  # noqa: ANN401 - a node
    """Return the text with a value set at a path; raise ValueError if there is no place for it."""
    # An empty value or '~' is null, and may become a mapping
    if not way or (isinstance(node, yaml.ScalarNode) and not node.value.strip('~')):
        for key in reversed(way):
            value = {key: value}
        inline = format_inline(value)
        # An empty value has no extent and needs a space after the colon
        begin, end = node.start_mark.index, node.end_mark.index
        return text[:begin] + (inline if end > begin else f' {inline}') + text[end:]
    if not isinstance(node, yaml.MappingNode):
        raise ValueError('cannot add a key to a value that is not a mapping')
    for key, below in node.value:
        if key.value == way[0]:
            return _set_in_text(text, below, way[1:], value)
    # Nest the value in the missing keys, from the inside out
    for key in reversed(way[1:]):
        value = {key: value}
    return _append_line(text, node, f'{way[0]}: {format_inline(value)}')


def _append_line(text: str, node: yaml.MappingNode, line: str) -> str:
    """Return the text with a line added at the end of a mapping."""
    if node.flow_style:
        # Before the closing brace
        end = node.end_mark.index - 1
        before = text[:end].rstrip()
        return before + (', ' if node.value else '') + line + text[end:]
    if not node.value:
        raise ValueError(
            'cannot add a key to an empty section; write one key into it by hand first'
        )
    # Indent as the first key
    column = node.value[0][0].start_mark.column
    end = text.find('\n', _find_value_end(node))
    end = len(text) if end < 0 else end
    return f'{text[:end]}\n{" " * column}{line}{text[end:]}'


def _find_value_end(node: yaml.Node) -> int:
    """Return the end of the last value in a node, without trailing comments."""
    if isinstance(node, yaml.MappingNode | yaml.SequenceNode) and not node.flow_style:
        last = node.value[-1]
        return _find_value_end(last[1] if isinstance(last, tuple) else last)
    end: int = node.end_mark.index
    return end
