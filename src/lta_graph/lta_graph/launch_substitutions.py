"""Evaluate `$(var NAME)`, `$(find-pkg-share PACKAGE)` and `$(dirname)` in ROS 2 launch files."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
import re
from typing import final

from lta_config.errors import BadInput, unknown_name_error
from lta_graph.ament import find_package_share

SUBSTITUTION = re.compile(r'\$\((?:(dirname)|(var|find-pkg-share) ([\w.-]+))\)')
# ROS unescapes a backslash; an unknown substitution or a nested one starts with '$(' as well
UNSUPPORTED = re.compile(r'\$\(|\\')


@final
@dataclass(frozen=True, slots=True)
class LaunchContext:
    """The context of substitutions: the folder of the launch file and its variables."""

    folder: Path
    variables: Mapping[str, str]


def expand_substitutions(text: str, context: LaunchContext) -> str:
    """
    Replace all substitutions in a text.

    Raises `BadInput` if a substitution is not supported or fails.
    """
    if UNSUPPORTED.search(SUBSTITUTION.sub('', text)):
        raise BadInput(
            f"'{text}' has a substitution or a backslash that lta launch does not support; use "
            'only $(var NAME), $(find-pkg-share PACKAGE) and $(dirname), or start the file with '
            '"ros2 launch".'
        )
    return SUBSTITUTION.sub(lambda match: _evaluate_substitution(match, context), text)


def split_command_line(text: str, context: LaunchContext) -> list[str]:
    """Split a command line at its spaces; the result of a substitution is never split."""
    if '"' in text or "'" in text:
        raise BadInput(
            f"The command line '{text}' has a quote, which lta launch does not support; remove "
            'it, or start the file with "ros2 launch".'
        )
    # The space inside $(var NAME) separates no words
    words = re.findall(r'(?:\$\([^)]*\)|\S)+', text)
    return [expand_substitutions(word, context) for word in words]


def has_substitution(text: str) -> bool:
    """Return whether a text contains a substitution."""
    return '$(' in text


def _evaluate_substitution(match: re.Match[str], context: LaunchContext) -> str:
    _, kind, name = match.groups()
    if kind is None:
        return str(context.folder)
    if kind == 'find-pkg-share':
        return str(find_package_share(name))
    if name not in context.variables:
        raise unknown_name_error('launch variable', name, list(context.variables))
    return context.variables[name]
