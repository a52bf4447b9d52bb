"""
Name the node that stalls a graph, from what each node reports to be waiting for.

When one node dies in lockstep, every node downstream waits for the one before it. The culprit is
the node that others wait for and that does not itself report waiting.
"""

from collections.abc import Iterable

from lta_graph.health import HealthFact, HealthLevel

INPUTS = 'inputs'
VEHICLE = {'simulator': 'vehicle', 'player': 'vehicle'}  # nodes whose role has another name


def find_stalling_roles(facts: Iterable[HealthFact]) -> list[str]:
    """
    Return the roles that keep others waiting, in alphabetical order.

    `facts`: the newest facts of all nodes, with tasks named 'NODE: TASK' as on /diagnostics. With
    several robots the robot's name comes first (`lta2/estimator: inputs`).
    """
    # `waiting` are roles that report missing inputs, `suspects` the roles they wait for
    waiting, suspects = set(), set()
    for fact in facts:
        node, _, task = fact.task.partition(': ')
        if task == INPUTS and fact.level == HealthLevel.ERROR:
            robot, slash, _ = node.rpartition('/')
            waiting.add(find_role(node))
            roles = set(fact.values.get('suspects', '').split(',')) - {''}
            # An absolute suspect (`/lta2/vehicle`) names its robot; a relative one belongs to the
            # same robot
            suspects |= {item[1:] if item[0] == '/' else robot + slash + item for item in roles}
    # A suspect that waits as well is only a link of the chain
    return sorted(suspects - waiting)


def find_role(node: str) -> str:
    """Return the role of a node, with the same robot prefix as the node's name."""
    robot, slash, name = node.rpartition('/')
    return robot + slash + VEHICLE.get(name, name)
