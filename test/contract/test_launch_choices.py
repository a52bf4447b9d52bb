"""Launch files offer every strategy: `lta fly` flies what `lta simulate` flies."""

from lta_config.files import find_file
from lta_control.strategies import STRATEGIES
from lta_graph.launch_file import list_arguments
import pytest

OFFERED = [
    ('fly', 'strategy'),
    ('emulated', 'strategy'),
    ('pair', 'strategy1'),
    ('pair', 'strategy2'),
]


@pytest.mark.parametrize(('file', 'name'), OFFERED)
def test_a_launch_file_offers_every_strategy(file, name):
    declared = list_arguments(find_file('launch file', file, '.launch.yaml'))
    (argument,) = (one for one in declared if one.name == name)
    assert set(argument.choices) == set(STRATEGIES)
