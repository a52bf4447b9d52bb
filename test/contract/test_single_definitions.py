"""
Each rule of the closed loop has one definition, and each closed loop is a driver on a short list.

A rule is known by the fields that it reads together, whatever its variables are called: a copy in
another module reads the same fields and is found.
"""

import ast
from collections import defaultdict
from collections.abc import Iterator, Mapping, Set
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[2]
Sources = Mapping[str, ast.Module]
Definition = ast.FunctionDef | ast.ClassDef


class Rule(NamedTuple):
    """The modules that define a rule, and the fields of which others read fewer than `least`."""

    homes: frozenset[str]
    fields: frozenset[str]
    least: int


def rule(homes: str, fields: str, least: int = 2) -> Rule:
    return Rule(frozenset(homes.split()), frozenset(fields.split()), least)


CONTROL, FLIGHT = 'lta_control/lta_control', 'lta_flight/lta_flight'
STUDIES = 'lta_studies/lta_studies'
RULES = {
    # The navigator node reports the lamp of a leg.
    'guidance': rule(
        f'{CONTROL}/mission.py {CONTROL}/flight_report.py',
        'leg target turns refused receptions', 3
    ),
    'change of lamps': rule(f'{CONTROL}/mission.py', 'reception_time patience again'),
    # The settings give their numbers to the rule.
    'action at the reserve': rule(f'{CONTROL}/reserve.py', 'action home patience turning'),
    'permission': rule(f'{CONTROL}/reserve.py', 'reserve urgent'),
    'termination': rule(
        'lta_sim/lta_sim/termination.py', 'limit half_length half_width door along'
    ),
    'reaching a lamp': rule('lta_sim/lta_sim/termination.py', 'radius vertical_tolerance'),
    'faults': rule('lta_model/lta_model/scenario.py', 'panel_short brown_out'),
    'anti-windup': rule(f'{CONTROL}/laws/cascade.py', 'shortfall', 1),
    'overturned drone': rule(f'{CONTROL}/flight_step.py', 'uprightness', 1),
    # What a flight in one process records; the graph's recorder takes the topics of its launch.
    'recording': rule(f'{FLIGHT}/messages.py', 'recorded repeatable'),
}  # fmt: skip
# Who may call a step of the closed loop.
CALLERS = {
    'mission_step': {f'{CONTROL}/guidance.py', f'{FLIGHT}/batch/control_period.py'},
    'course_step': {f'{CONTROL}/guidance.py'},
    'fly_phase': {f'{CONTROL}/mission.py', f'{CONTROL}/commanded_flight.py'},
    'choose_setpoint': {f'{CONTROL}/nodes/navigator.py', f'{FLIGHT}/closed_loop.py'},
    'decide_permission': {f'{CONTROL}/guidance.py', f'{CONTROL}/commanded_flight.py'},
    'apply_reserve': {f'{CONTROL}/mission.py', f'{CONTROL}/commanded_flight.py'},
    'permission_at_reserve': {f'{CONTROL}/reserve.py', f'{FLIGHT}/batch/control_period.py'},
    'allocate': {f'{CONTROL}/allocation.py'},
    'is_plausible_imu_sample': {
        f'{CONTROL}/flight_step.py', f'{FLIGHT}/closed_loop.py',
    },
    'advance_position': {f'{CONTROL}/estimator.py', f'{CONTROL}/odometry/airspeed.py'},
    'is_control_input_finite': {f'{CONTROL}/flight_step.py'},
    'watch_flight': {f'{CONTROL}/flight_step.py'},
    # In the graph the estimate comes by a message.
    'control_motors': {f'{CONTROL}/flight_step.py', f'{CONTROL}/nodes/controller.py'},
    # In one process the autopilot compiles it.
    'flight_step': {f'{FLIGHT}/batch/control_period.py'},
    'is_shorted': {'lta_sim/lta_sim/supply.py'},
    'is_cut_off': {'lta_sim/lta_sim/supply.py'},
    'advance_supply': {f'{FLIGHT}/batch/control_period.py'},
    'deliver_demand': {f'{CONTROL}/laws/cascade.py', f'{STUDIES}/tune/loop_cut.py'},
    'cascade_step': {f'{CONTROL}/laws/cascade.py'},
    'newest_range': {f'{FLIGHT}/closed_loop.py'},
    'simulate_period': {f'{FLIGHT}/batch/flight_loop.py', f'{STUDIES}/mission/leg_state.py'},
    # `FlightTermination` in the same module is what the world calls.
    'evaluate_outcome': {
        'lta_sim/lta_sim/termination.py', 'lta_sim/lta_sim/world.py', f'{FLIGHT}/batch/flight.py'
    },
    # All who write a bag of a flight in one process.
    'LoopRecorder': {
        f'{FLIGHT}/simulate.py',
        'lta_discovery/lta_discovery/demo/hidden_effect.py',
    },
    'has_diverged': {
        'lta_sim/lta_sim/world.py', f'{FLIGHT}/batch/flight.py', f'{STUDIES}/mission/leg_state.py'
    },
}  # fmt: skip
# A closed loop reads sensors, decides, and advances the vehicle.
SENSE = {
    'sense', 'sense_motion', 'sense_rest', 'read_sensors', 'simulate_sensors', 'sense_and_control'
}  # fmt: skip
DECIDE = {
    'step', 'decide', 'flight_step', 'control_motors', 'control_step', 'cascade_step',
    'estimator_step', 'sense_and_control',
}  # fmt: skip
ADVANCE = {'advance', 'advance_vehicle', 'simulate_control_period', 'runge_kutta_step'}
DRIVERS = {
    f'{FLIGHT}/closed_loop.py: ClosedLoop',
    f'{FLIGHT}/batch/control_period.py: simulate_period',
    # One period without noise, opened at the demand, for the margins
    f'{STUDIES}/tune/loop_cut.py: LoopCut',
    # The Crazyflie's own firmware, with its own controller
    'lta_emulation/lta_emulation/crazyflie/simulated_body.py: SimulatedBody',
}


@cache
def sources() -> Sources:
    base = ROOT / 'src'
    return {
        str(path.relative_to(base)): ast.parse(path.read_text())
        for path in sorted(base.glob('lta_*/lta_*/**/*.py'))
    }


@cache
def called_names(tree: ast.AST) -> set[str]:
    functions = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
    return {
        node.attr if isinstance(node, ast.Attribute) else node.id
        for node in functions
        if isinstance(node, ast.Attribute | ast.Name)
    }


def field_reads(tree: ast.AST, fields: Set[str]) -> Iterator[set[str]]:
    """Yield which of some fields each function reads of each object."""
    for attributes in attributes_by_function(tree):
        reads = defaultdict(set)
        for node in attributes:
            if node.attr in fields:
                reads[ast.unparse(node.value)].add(node.attr)
        yield from reads.values()


@cache
def attributes_by_function(tree: ast.AST) -> list[list[ast.Attribute]]:
    return [
        [node for node in ast.walk(function) if isinstance(node, ast.Attribute)]
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef)
    ]


def find_definitions(wanted: Rule, modules: Sources) -> set[str]:
    """Return the modules that read enough fields of a rule together."""
    return {
        name
        for name, tree in modules.items()
        if any(len(fields) >= wanted.least for fields in field_reads(tree, wanted.fields))
    }


def find_closed_loops(modules: Sources) -> set[str]:
    """Return the functions and classes that read sensors, decide and advance."""
    found = set()
    for name, tree in modules.items():
        for node in tree.body:
            if isinstance(node, Definition):
                calls = called_names(node)
                if calls & SENSE and calls & DECIDE and calls & ADVANCE:
                    found.add(f'{name}: {node.name}')
    return found


def find_newest_range_reads(modules: Sources) -> set[str]:
    """Return the modules that take the last item of ranges."""
    return {
        name
        for name, tree in modules.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Subscript) and ast.unparse(node).endswith('ranges[-1]')
    }


@pytest.mark.parametrize('name', RULES)
def test_each_rule_has_one_definition(name):
    assert find_definitions(RULES[name], sources()) == RULES[name].homes


@pytest.mark.parametrize('name', CALLERS)
def test_each_step_is_called_by_the_drivers_only(name):
    callers = {path for path, tree in sources().items() if name in called_names(tree)}
    assert callers == CALLERS[name]


def test_the_closed_loops_are_the_drivers():
    assert find_closed_loops(sources()) == DRIVERS


def test_the_newest_range_is_chosen_once():
    # The firmware logs its latest range, in range or not.
    assert find_newest_range_reads(sources()) == {
        f'{FLIGHT}/closed_loop.py',
        'lta_emulation/lta_emulation/crazyflie/simulated_body.py',
    }


@pytest.mark.parametrize('name', RULES)
def test_a_copy_of_a_rule_is_found(name):
    """Every function of the rule's module, with other names for its variables."""
    (home, *_) = sorted(RULES[name].homes)
    text = (ROOT / 'src' / home).read_text()
    for old in ('settings', 'mission', 'rule', 'goal', 'word', 'memory', 'drone'):
        text = text.replace(f'{old}.', f'other_{old}.').replace(f'{old}: ', f'other_{old}: ')
    copy = {**sources(), 'lta_studies/lta_studies/copy.py': ast.parse(text)}
    assert find_definitions(RULES[name], copy) - RULES[name].homes == {
        'lta_studies/lta_studies/copy.py'
    }


LOOP = """
def fly(world, pilot, reach):
    for _ in range(100):
        readings = world.sense_motion()
        distance = readings.ranges[-1][1] if readings.ranges else math.nan
        world.advance(pilot.step(readings.rates, readings.force, distance))
"""


def test_a_loop_by_hand_is_found():
    copy = {'copy.py': ast.parse(LOOP)}
    assert find_closed_loops(copy) == {'copy.py: fly'}
    assert find_newest_range_reads(copy) == {'copy.py'}
    for part in ('world.sense_motion()', 'pilot.step', 'world.advance'):
        assert find_closed_loops({'copy.py': ast.parse(LOOP.replace(part, 'none(0)'))}) == set()
