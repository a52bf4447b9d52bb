"""What can be wrong with the nodes of a launch plan, found before any of them starts."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

from lta_config.constants import AIR_DENSITY
from lta_config.errors import BadInput
from lta_config.files import checked, parse_yaml
from lta_control.laws.aboard import check_aboard
from lta_control.strategies import check_route, strategy
from lta_flight.listening import check_listening
from lta_graph.launch_file import LaunchPlan
from lta_model.scenario import load_scenario
from lta_model.start_offset import started
from lta_model.vehicle import load_vehicle
from lta_sim import in_scene
from lta_vlc.settings import Demodulation

OURS = 'lta_'
CONTROLLER, DEMODULATOR, NAVIGATOR = 'controller', 'demodulator', 'navigator'
FILE_OPTION = '--params-file'
SEEDS = range(2**31)


def check(plan: LaunchPlan) -> None:
    """
    Refuse a vehicle, scenario, strategy or seed that LTA's own nodes would refuse.

    And a lamp that nobody listens for, of which no node knows by itself.

    Raises
    ------
    BadInput
        The sentence that the node would have ended with.

    """
    for process in plan.processes:
        if process.package.startswith(OURS):
            for given in by_robot(parameters(process.arguments)):
                check_parameters(given, controls=process.executable == CONTROLLER)
    check_heard(plan)


def check_parameters(given: Mapping[str, object], controls: bool) -> None:
    """
    Refuse what one node would refuse.

    Parameters
    ----------
    given : mapping
        Its parameters by name.
    controls : bool
        Whether it is the controller, which needs a law of the vehicle's.

    """
    density, scenario = AIR_DENSITY, None
    if isinstance(name := given.get('scenario'), str):
        scenario = started(load_scenario(name), *offset(given))
        _ = scenario.light_field
        density = scenario.air.density
    if isinstance(name := given.get('vehicle'), str):
        vehicle = load_vehicle(name, density)
        _ = vehicle.hover_duty
        if controls:
            check_aboard(vehicle)
        if scenario is not None:
            in_scene.check(vehicle, scenario)
    if isinstance(name := given.get('strategy'), str):
        check_route(strategy(name), 1 if scenario is None else len(scenario.route))
    if 'seed' in given and not (type(given['seed']) is int and given['seed'] in SEEDS):
        raise BadInput(
            f'The seed is {given["seed"]}, but must be a whole number from 0 to {SEEDS[-1]}.'
        )


def check_heard(plan: LaunchPlan) -> None:
    """Refuse a scene whose lamp the demodulator beside its navigator does not listen for."""
    ours = {
        (process.namespace, process.executable): process.arguments
        for process in plan.processes
        if process.package.startswith(OURS)
    }
    for (namespace, executable), arguments in ours.items():
        listener = ours.get((namespace, DEMODULATOR))
        scenario = parameters(arguments).get('scenario')
        if executable != NAVIGATOR or listener is None or not isinstance(scenario, str):
            continue
        if FILE_OPTION in listener:  # what it is set to stands in a file of whoever wrote it
            continue
        own = parameters(listener)
        given = {name: own[name] for name in Demodulation.model_fields if name in own}
        check_listening(
            load_scenario(scenario), checked(Demodulation, given, 'the settings of demodulator')
        )


def parameters(arguments: Sequence[str]) -> dict[str, object]:
    """Return the parameters that a node's command line gives one by one."""
    rules = (rule.partition(':=') for word, rule in pairwise(arguments) if word == '-p')
    return {name: parse_yaml(value, name) for name, _, value in rules}


def by_robot(given: Mapping[str, object]) -> list[dict[str, object]]:
    """Return parameters of the node itself, and those of each robot in a recorder's care."""
    found: dict[str, dict[str, object]] = {}
    for name, value in given.items():
        robot, _, own = name.rpartition('.')
        found.setdefault(robot, {})[own] = value
    return list(found.values())


def offset(given: Mapping[str, object]) -> tuple[float, float]:
    """Return by how much a node's parameters move the start; what is no number moves nothing."""
    x, y = (given.get(name) for name in ('offset_x', 'offset_y'))
    return x if isinstance(x, float) else 0.0, y if isinstance(y, float) else 0.0
