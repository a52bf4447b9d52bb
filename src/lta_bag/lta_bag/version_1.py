# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Recognize bags of version 1, which had standard messages on four topics.

`lta bag upgrade` converts them; no other command reads them.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from lta_config.errors import BadInput

OLD_TYPES: Final = {  # by relative topic
    'photodiodes': 'sensor_msgs/msg/Image',
    'light/peaks': 'sensor_msgs/msg/PointCloud2',
    'energy/status': 'diagnostic_msgs/msg/DiagnosticArray',
}


def find_old_topics(types: Mapping[str, str], provenance: Mapping[str, str]) -> dict[str, str]:
    """
    Return the topics with messages of version 1: relative names, by absolute name.

    `types`: the message types of a bag, by absolute name. An import has none of them: it keeps
    topics of others.
    """
    if 'importer' in provenance:
        return {}
    return {
        full: name
        for name, old in OLD_TYPES.items()
        for full, kind in types.items()
        if kind == old and (full == f'/{name}' or full.endswith(f'/{name}'))
    }


def describe_old_topics(
    path: Path, types: Mapping[str, str], provenance: Mapping[str, str]
) -> str:
    """Return a sentence with the remedy for a bag of version 1; '' for others. See above."""
    names = sorted(set(find_old_topics(types, provenance).values()))
    if not names:
        return ''
    return (
        f"'{path}' has messages of version 1 on {', '.join(names)}; convert it with: "
        f'lta bag upgrade {path}'
    )


def refuse_old_bag(path: Path, types: Mapping[str, str], provenance: Mapping[str, str]) -> None:
    """Raise `BadInput` if a bag has messages of version 1; arguments as for `find_old_topics`."""
    if sentence := describe_old_topics(path, types, provenance):
        raise BadInput(sentence)
