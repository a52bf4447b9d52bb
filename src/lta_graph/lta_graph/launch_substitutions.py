r"""
Evaluate substitutions of ROS 2 launch files: `$(var x)`, `$(env X default)` and others.

Substitutions can be nested: `$(find-pkg-share $(var package))`. An argument with spaces needs
quotes; `\$` is a dollar sign. `$(eval ...)` and `$(command ...)`, which run code, are not
supported.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
import os
from pathlib import Path
from typing import final

from lta_config.errors import BadInput, unknown_name_error
from lta_graph.ament import find_package_share


@final
@dataclass(frozen=True, slots=True)
class LaunchContext:
    """The context of substitutions: the folder of the launch file and its variables."""

    folder: Path
    variables: Mapping[str, str]


def _substitute_variable(context: LaunchContext, name: str) -> str:
    if name not in context.variables:
        raise unknown_name_error('launch variable', name, list(context.variables))
    return context.variables[name]


def _substitute_environment(_: LaunchContext, name: str, default: str | None = None) -> str:
    value = os.environ.get(name, default)
    if value is None:
        raise BadInput(
            f'The environment variable {name} is not set; set it, or give a default, as in '
            f'$(env {name} DEFAULT).'
        )
    return value


def _substitute_package_share(_: LaunchContext, package: str) -> str:
    return str(find_package_share(package))


def _substitute_dirname(context: LaunchContext) -> str:
    return str(context.folder)


SUBSTITUTIONS: dict[str, tuple[Callable[..., str], int, int]] = {
    # name: (function, fewest arguments, most arguments)
    'var': (_substitute_variable, 1, 1),
    'env': (_substitute_environment, 1, 2),
    'find-pkg-share': (_substitute_package_share, 1, 1),
    'dirname': (_substitute_dirname, 0, 0),
}


def expand_substitutions(text: str, context: LaunchContext) -> str:
    """
    Replace all substitutions in a text.

    Raises `BadInput` if a substitution is unknown, ill-formed or fails.
    """
    result, end = _read_text(text, 0, context, stop='')
    # Without stop characters the reader consumes everything
    assert end == len(text)
    return result


def split_command_line(text: str, context: LaunchContext) -> list[str]:
    """Split a command line into words; the result of a substitution is never split."""
    words, _ = _read_words(text, 0, context, stop='')
    return words


def has_substitution(text: str) -> bool:
    """Return whether a text contains a substitution."""
    # An escaped dollar sign starts no substitution
    return '$(' in text.replace('\\$', '')


def _read_text(text: str, at: int, context: LaunchContext, stop: str) -> tuple[str, int]:
    """Return the text up to one of the `stop` characters, and its position."""
    parts = []
    while at < len(text) and text[at] not in stop:
        # Escapes of ROS: a backslash before $, a quote or a backslash
        if text.startswith('\\', at) and at + 1 < len(text) and text[at + 1] in '$"\'\\':
            parts.append(text[at + 1])
            at += 2
        elif text.startswith('$(', at):
            made, at = _read_substitution(text, at, context)
            parts.append(made)
        else:
            parts.append(text[at])
            at += 1
    return ''.join(parts), at


def _read_words(text: str, at: int, context: LaunchContext, stop: str) -> tuple[list[str], int]:
    """Return the unquoted words up to one of the `stop` characters, and its position."""
    words: list[str] = []
    joined = False  # whether the next piece continues the last word
    while at < len(text) and text[at] not in stop:
        if text[at].isspace():
            joined, at = False, at + 1
            continue
        if text[at] in '\'"':
            piece, end = _read_text(text, at + 1, context, stop=text[at])
            if end == len(text):
                raise BadInput(f"'{text}' has a quote without its closing quote; add it.")
            at = end + 1
        else:
            piece, at = _read_text(text, at, context, stop=' \t\n\'"' + stop)
        # As in a shell, a"b c" is one word
        words = [*words[:-1], words[-1] + piece] if joined else [*words, piece]
        joined = True
    return words, at


def _read_substitution(text: str, start: int, context: LaunchContext) -> tuple[str, int]:
    """Return the value of the substitution at `start`, and the position after it."""
    # Skip the two characters '$('; words inside may contain substitutions themselves
    words, at = _read_words(text, start + 2, context, stop=')')
    if at == len(text):
        raise BadInput(f"'{text}' has a substitution without a closing ')'; add it.")
    return _evaluate_substitution(words, text[start : at + 1], context), at + 1


def _evaluate_substitution(words: list[str], source: str, context: LaunchContext) -> str:
    name = words[0] if words else ''
    if name not in SUBSTITUTIONS:
        raise unknown_name_error(
            'substitution', source, [f'$({item} ...)' for item in SUBSTITUTIONS]
        )
    function, fewest, most = SUBSTITUTIONS[name]
    if not fewest <= len(words) - 1 <= most:
        count = str(fewest) if fewest == most else f'{fewest} or {most}'
        raise BadInput(f"'{source}' has {len(words) - 1} arguments, but $({name}) takes {count}.")
    return function(context, *words[1:])
