# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Set values in a vehicle file, and keep its comments and order.

ruamel.yaml reads and writes the text. The shipped files have the form that it writes, so that a
new number changes one line.
"""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from io import StringIO
from typing import Any, Final

from lta_config.errors import BadInput
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import CommentMark
from ruamel.yaml.resolver import VersionedResolver
from ruamel.yaml.tokens import CommentToken
import yaml

LINE_WIDTH: Final = 10**6  # characters per line, so that no value is folded
KEPT_TAGS: Final = (':null', ':merge')  # of plain scalars that mean more than their text


class _LeafDumper(yaml.SafeDumper):
    """Write quantities, and what holds no mapping, on one line each, and no anchors."""

    def ignore_aliases(self, data: Any) -> bool:
        """Write what two places share twice."""
        return True

    def represent_mapping(self, tag: str, mapping: Any, flow_style: Any = None) -> Any:
        """Represent a mapping."""
        in_line = 'unit' in mapping or not any(map(_holds_mapping, mapping.values()))
        return super().represent_mapping(tag, mapping, in_line)

    def represent_sequence(self, tag: str, sequence: Any, flow_style: Any = None) -> Any:
        """Represent a list."""
        return super().represent_sequence(tag, sequence, not _holds_mapping(sequence))


def _holds_mapping(value: Any) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list | tuple) and any(map(_holds_mapping, value))
    )


def format_yaml(value: Any) -> str:
    """Return a value as YAML: quantities on one line each, mappings of them as blocks."""
    return yaml.dump(
        value, Dumper=_LeafDumper, sort_keys=False, width=LINE_WIDTH, allow_unicode=True
    )


class _KeepScalars(VersionedResolver):
    """Read every plain scalar but null as it is written, so that no digit of a number changes."""

    @property
    def versioned_resolver(self) -> dict[str | None, list[tuple[str, Any]]]:
        """Return the resolvers by the first character of a scalar."""
        return {
            first: [(tag, regexp) for tag, regexp in resolvers if tag.endswith(KEPT_TAGS)]
            for first, resolvers in super().versioned_resolver.items()
        }


def set_yaml_values(text: str, values: Mapping[str, Any]) -> str:
    """
    Return a file's text with values set at dotted places, such as 'trim.heaviness'.

    `text`: a mapping in YAML. `values`: new values by place; missing keys are created. Raise
    `BadInput` if a place leads through something that is not a mapping.
    """
    editor = YAML()
    editor.Resolver = _KeepScalars
    editor.preserve_quotes = True
    editor.width = LINE_WIDTH
    content = editor.load(text)
    for place, value in values.items():
        node, way = content, place.split('.')
        while len(way) > 1 and node.get(way[0]) is not None:
            below = node[way[0]]
            if not isinstance(below, CommentedMap):
                raise BadInput(
                    f"'{way[1]}' cannot be set in the vehicle file, because the key above it has "
                    'a value instead of keys; remove that value from the file first.'
                )
            if below.anchor.value is not None:
                # Its aliases keep the old values
                below = node[way[0]] = deepcopy(below)
                below.yaml_set_anchor(None)
            node, way = below, way[1:]
        for key in reversed(way[1:]):
            value = {key: value}
        _put(node, way[0], editor.load(format_yaml(value)))
    out = StringIO()
    editor.dump(content, out)
    return out.getvalue()


def _put(node: CommentedMap, key: str, value: Any) -> None:
    """Set a value, and leave the comments below it where they are."""
    # ruamel.yaml keeps what stands below a value with the value, or with its last leaf
    beside, below = '', ''
    if key in node:
        beside, below = _take_comment(node, key)
    elif node and not node.fa.flow_style():
        last = next(reversed(node))
        beside, below = _take_comment(node, last)
        _set_comment(node, last, beside)
        beside = ''
    node[key] = value
    _set_comment(node, key, f'{beside}\n{below}' if beside or below else '')


def _descend(node: Any, key: Any) -> Iterator[tuple[Any, Any]]:
    """Yield the way to the last value in block form at or below a key, as collection and key."""
    yield node, key
    below = node[key]
    if isinstance(below, CommentedMap | CommentedSeq) and below and not below.fa.flow_style():
        last = next(reversed(below)) if isinstance(below, CommentedMap) else len(below) - 1
        yield from _descend(below, last)


def _take_comment(node: CommentedMap, key: str) -> tuple[str, str]:
    """Remove and return the comment beside the last leaf of a value, and the lines below it."""
    below = ''
    for holder, last in _descend(node, key):
        leaf = holder[last]
        # A list keeps what stands below it itself
        for token in (getattr(leaf, 'ca', None) and leaf.ca.end) or ():
            below += ' ' * token.start_mark.column * token.value.startswith('#') + token.value
        if below:
            leaf.ca.end.clear()
    slots = holder.ca.items.get(last)
    place = 0 if isinstance(holder, CommentedSeq) else 2
    if not slots or slots[place] is None:
        return '', below
    beside, _, text = slots[place].value.partition('\n')
    slots[place] = None
    if isinstance(leaf, CommentedMap | CommentedSeq):
        leaf.ca.comment = None
    return beside, text + below


def _set_comment(node: CommentedMap, key: str, text: str) -> None:
    """Set the comment that begins beside the last leaf of a value."""
    if text:
        *_, (holder, last) = _descend(node, key)
        token = CommentToken(text if '\n' in text else f'{text}\n', CommentMark(0), None)
        is_list = isinstance(holder, CommentedSeq)
        holder.ca.items[last] = [token, None] if is_list else [None, None, token, None]
