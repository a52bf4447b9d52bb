"""Under `ros2 launch`, each node of our files ends with it, and holds Ctrl-C as it starts."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

LAUNCH = Path(__file__).resolve().parents[2] / 'config/launch'
PREFIX = {'name': 'launch-prefix', 'value': 'setpriv --pdeathsig INT env --block-signal=INT'}


def iterate_nodes(actions: list[dict[str, Any]], prefixed: bool) -> Iterator[tuple[dict, bool]]:
    """Yield each node, and whether the prefix is set for it."""
    for action in actions:
        prefixed = prefixed or action.get('let') == PREFIX
        yield from ((action['node'], prefixed) for _ in action if 'node' in action)
        yield from iterate_nodes(action.get('group', []), prefixed)


@pytest.mark.parametrize('path', sorted(LAUNCH.glob('*.launch.yaml')), ids=lambda path: path.name)
def test_every_node_has_the_prefix_and_its_own_name_in_the_output(path):
    nodes = list(iterate_nodes(yaml.safe_load(path.read_text('utf-8'))['launch'], False))
    assert nodes
    assert [node['exec'] for node, prefixed in nodes if not prefixed] == []
    # launch would name the process after the first word of the prefix
    assert [node.get('exec_name') for node, _ in nodes] == [node['exec'] for node, _ in nodes]
