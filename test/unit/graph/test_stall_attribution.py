# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Who holds several robots up: the one that somebody waits for and that does not wait itself."""

from lta_graph.health import find_stalling_roles, HealthFact, HealthLevel


def waiting(node, *suspects):
    return HealthFact(f'{node}: inputs', HealthLevel.ERROR, '', {'suspects': ','.join(suspects)})


def test_one_robot_by_hand():
    facts = [waiting('controller', 'estimator'), waiting('simulator', 'controller')]
    facts.append(waiting('energy_monitor', 'vehicle'))
    assert find_stalling_roles(facts) == ['estimator']
    assert find_stalling_roles([waiting('simulator', '')]) == []


def test_a_robot_that_waits_for_another_blames_neither_itself_nor_the_simulator():
    """The estimator of lta2 hangs; the simulator waits for duties, and all of lta1 for it."""
    facts = [
        waiting('lta2/controller', 'estimator'),
        waiting('simulator', '/lta2/controller'),
        waiting('lta1/estimator', 'vehicle'),
        waiting('lta1/controller', 'estimator'),
    ]
    assert find_stalling_roles(facts) == ['lta2/estimator']
    # The same name in the other robot is not excused by this one's waiting.
    assert find_stalling_roles([waiting('lta1/estimator', 'vehicle'), facts[0]]) == [
        'lta1/vehicle',
        'lta2/estimator',
    ]
