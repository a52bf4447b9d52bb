"""A launch plan is checked before anything starts."""

from lta_analysis.preflight import check
from lta_config.errors import BadInput
from lta_config.files import known
from lta_graph.launch_file import LaunchPlan
from lta_graph.launch_node import Process
import pytest


def plan(*words, package='lta_sim'):
    arguments = ['--ros-args', *(part for word in words for part in ('-p', word))]
    return LaunchPlan((Process(package, 'node', 'node', '/', tuple(arguments), False),))


@pytest.mark.parametrize(
    ('word', 'sentence'),
    [
        (
            'vehicle:="nope"',
            f"Unknown vehicle 'nope'; known: {', '.join(known('vehicles'))}.",
        ),
        (
            'scenario:="moon"',
            f"Unknown scenario 'moon'; known: {', '.join(known('scenarios'))}.",
        ),
        ('strategy:="luck"', "Unknown strategy 'luck'; known: bag, des, dga, homing."),
        ('seed:=-1', 'The seed is -1, but must be a whole number from 0 to 2147483647.'),
        ('seed:="1"', 'The seed is 1, but must be a whole number from 0 to 2147483647.'),
        ('seed:=true', 'The seed is True, but must be a whole number from 0 to 2147483647.'),
    ],
)
def test_what_a_node_would_refuse_is_refused_before(word, sentence):
    with pytest.raises(BadInput) as caught:
        check(plan(word))
    assert str(caught.value) == sentence
    check(plan(word, package='their_sim'))


def test_a_good_plan_passes():
    check(plan('vehicle:="gtmab"', 'scenario:="lamp_room"', 'strategy:="bag"', 'seed:=0'))
