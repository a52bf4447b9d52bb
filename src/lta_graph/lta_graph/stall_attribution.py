"""
Who holds the graph up: from what each node says it is waiting for.

When one node dies in lockstep, all downstream of it wait, each for the one before. The culprit is
whom somebody waits for and who does not say that it is itself waiting.
"""

from collections.abc import Iterable

from lta_graph.health import HealthFact, HealthLevel

INPUTS = 'inputs'
VEHICLE = {'simulator': 'vehicle', 'player': 'vehicle'}  # nodes whose role has another name


def find_stalled_roles(facts: Iterable[HealthFact]) -> list[str]:
    """
    Return the roles that keep others waiting, in alphabetical order.

    Parameters
    ----------
    facts : iterable of Fact
        The newest facts of all nodes, tasks named 'NODE: TASK' as on /diagnostics, with the
        robot's name before it (`lta2/estimator: inputs`) where they are of several.

    """
    waiting, suspects = set(), set()
    for fact in facts:
        node, _, task = fact.task.partition(': ')
        if task == INPUTS and fact.level == HealthLevel.ERROR:
            robot, slash, _ = node.rpartition('/')
            waiting.add(find_role(node))
            roles = set(fact.values.get('suspects', '').split(',')) - {''}
            suspects |= {item[1:] if item[0] == '/' else robot + slash + item for item in roles}
    return sorted(suspects - waiting)


def find_role(node: str) -> str:
    """Return the role that a node plays, with its robot's name before it as the node has it."""
    robot, slash, name = node.rpartition('/')
    return robot + slash + VEHICLE.get(name, name)
