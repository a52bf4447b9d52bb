# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Each barrier of the hazard table has a test that fails without it."""

import os
from pathlib import Path
import re
from typing import NamedTuple

from campaigns.mutation import Copy, KILLED
import pytest

ROOT = Path(__file__).resolve().parents[2]
BRIDGE = 'src/lta_bridge/lta_bridge'
CONTROL = 'src/lta_control/lta_control'
RULES = 'test/unit/control/test_flight_step.py'
UNIT = 'test/unit/bridge/crazyflie'
LIMIT = 600  # s of processor time for the test of a barrier


class Barrier(NamedTuple):
    """A barrier: its source, the text that makes it, what is left without it, and its test."""

    source: str
    text: str
    without: str
    test: str


BARRIERS = {
    'firmware of another vehicle': Barrier(
        f'{BRIDGE}/crazyflie/connection_manager.py',
        'if value is None or int(value) == airframe:', 'if True:',
        f'{UNIT}/test_crazyflie_link.py',
    ),
    'light board of another vehicle': Barrier(
        f'{BRIDGE}/teensy/light_board.py',
        'elif self.vehicle and self._vehicle not in (None, self.vehicle):', 'elif False:',
        'test/unit/bridge/test_teensy_light_board.py',
    ),
    'no estimate': Barrier(
        f'{BRIDGE}/crazyflie/safety.py',
        'return math.isinf(inputs.place_age) or math.isnan(inputs.height) or '
        'math.isnan(inputs.distance)', 'return False',
        'test/property/test_crazyflie_safety.py',
    ),
    'old estimate': Barrier(
        f'{BRIDGE}/crazyflie/safety.py', 'if LOST_POSITION < inputs.place_age < math.inf:',
        'if False:',
        'test/property/test_crazyflie_safety.py',
    ),
    'tracker': Barrier(
        f'{BRIDGE}/crazyflie/bridge_core.py', 'if len(recent) == len(both):', 'if False:',
        f'{UNIT}/test_crazyflie_cores.py',
    ),
    'rises': Barrier(
        f'{BRIDGE}/crazyflie/buoyancy.py',
        'self.rises = last - middle >= max(LEAST_RISE, LEAST_RISE_SHARE * (middle - first))',
        'self.rises = False',
        f'{UNIT}/test_buoyancy.py',
    ),
    'held down': Barrier(
        f'{BRIDGE}/crazyflie/buoyancy.py',
        'self.is_held_down = self._pushed_since <= began and (self.rises or still)',
        'self.is_held_down = False', f'{UNIT}/test_buoyancy.py',
    ),
    'downward thrust': Barrier(
        f'{CONTROL}/vehicle_parameters.py',
        'lowest_heave=_lowest_heave(vehicle, low, high)', 'lowest_heave=0.0',
        'test/unit/control/test_downward_thrust.py',
    ),
    'a landing ends': Barrier(
        f'{CONTROL}/flight_step.py',
        'return LandingWatch(watch.lowest, watch.still + dt)', 'return watch',
        'test/unit/control/test_downward_thrust.py',
    ),
    'a landing that has ended': Barrier(
        f'{CONTROL}/flight_step.py', 'elif landing.still > STANDSTILL:', 'elif False:',
        RULES,
    ),
    'a landing ends by the bridge': Barrier(
        f'{BRIDGE}/crazyflie/safety.py', 'if inputs.grounded > GROUNDED:', 'if False:',
        f'{UNIT}/test_buoyancy.py',
    ),
    'a landing is reported': Barrier(
        f'{CONTROL}/commanded_flight.py',
        ' or self._landing.still > LANDED', '', 'test/unit/control/test_commanded_flight.py',
    ),
    'carried up': Barrier(
        f'{CONTROL}/commanded_flight.py',
        'if task is not None and not task.driven:', 'if False:',
        'test/unit/control/test_commanded_flight.py',
    ),
    'stuck range finder': Barrier(
        f'{CONTROL}/estimator.py',
        'math.nan if is_stuck(sensors.range) else distance', 'distance',
        'test/unit/control/test_estimator.py',
    ),
    'stuck sensors': Barrier(
        f'{CONTROL}/estimator.py',
        'return not (is_stuck(estimate.sensors.range) and is_stuck(estimate.sensors.pressure))',
        'return True', 'test/unit/control/test_estimator.py',
    ),
    'overturned': Barrier(
        f'{CONTROL}/flight_step.py',
        'has_overturned(motion.attitude, rules.uprightness):', 'False:',
        RULES,
    ),
    'unknown height': Barrier(
        f'{CONTROL}/flight_step.py', 'elif inputs.armed and lost:', 'elif False:', RULES,
    ),
    'height that no sensor measures': Barrier(
        f'{CONTROL}/flight_step.py', ' or (inputs.blind and turning)', '', RULES,
    ),
    'not a number': Barrier(
        f'{CONTROL}/flight_step.py', 'elif not is_control_input_finite(motion, setpoint):',
        'elif False:', RULES,
    ),
    'stopped for good': Barrier(
        f'{CONTROL}/flight_step.py', 'if is_stopped(before.state):', 'if False:', RULES,
    ),
    'disarmed': Barrier(
        f'{CONTROL}/flight_step.py', 'elif not (inputs.armed and steered):',
        'elif not steered:', RULES,
    ),
    'old setpoint': Barrier(
        f'{CONTROL}/flight_step.py', 'if inputs.age > rules.land_after:', 'if False:', RULES,
    ),
    'must land': Barrier(
        f'{CONTROL}/flight_step.py', 'if inputs.must_land:', 'if False:', RULES,
    ),
    'stuck height by the bridge': Barrier(
        f'{BRIDGE}/crazyflie/bridge_core.py', 'math.nan if stuck else where.height',
        'where.height', f'{UNIT}/test_buoyancy.py',
    ),
    'stuck sensor by setpoints': Barrier(
        f'{BRIDGE}/crazyflie/bridge_core.py', ' or bool(self.find_stuck_sensor())', '',
        f'{UNIT}/test_buoyancy.py',
    ),
    'calibrating': Barrier(
        f'{BRIDGE}/crazyflie/messages.py', 'if not has_estimate(odom.pose.covariance[0]):',
        'if False:', f'{UNIT}/test_crazyflie_cores.py',
    ),
    'a rotor that holds down obeys': Barrier(
        f'{BRIDGE}/crazyflie/safety.py',
        "why = ON_REQUEST if request.arm is False else find_landing_reason(state, now, inputs, "
        'limits)', 'why = find_landing_reason(state, now, inputs, limits)',
        f'{UNIT}/test_buoyancy.py',
    ),
    'armed at rest': Barrier(
        f'{CONTROL}/flight_step.py', 'elif not flies:', 'elif False:', RULES,
    ),
    'armed at rest, by setpoints': Barrier(
        f'{BRIDGE}/crazyflie/bridge_core.py', ' and self._may_rise(self._command)', '',
        f'{UNIT}/test_bridge.py',
    ),
    'time stands still': Barrier(
        f'{BRIDGE}/crazyflie/bridge_core.py', 'elif now - self._graph_at > safety.STALE:',
        'elif False:', f'{UNIT}/test_bridge.py',
    ),
    'two commanders before arming': Barrier(
        f'{BRIDGE}/crazyflie/safety.py',
        "return f'{inputs.rivals}: stop them, or allow them with allow_other_commanders:=true'",
        'pass',
        f'{UNIT}/test_bridge.py',
    ),
    'two commanders in flight': Barrier(
        f'{BRIDGE}/crazyflie/safety.py', "return inputs.rivals\n",
        'pass\n', f'{UNIT}/test_bridge.py',
    ),
    'two navigators before arming': Barrier(
        f'{CONTROL}/nodes/controller.py',
        'refusal = (flight_report.describe_stop(watch.state) or rivals) if request.data',
        'refusal = flight_report.describe_stop(watch.state) if request.data',
        'test/integration/test_nodes.py',
    ),
    'two navigators in flight': Barrier(
        f'{CONTROL}/nodes/controller.py',
        'self._contested or self._helm.count_commanders() > 1', 'False',
        'test/integration/test_nodes.py',
    ),
    'armed by a bridge only': Barrier(
        'src/lta_graph/lta_graph/launch_arguments.py',
        "return self.is_simulated or self.source == 'replay'", 'return True',
        'test/unit/flight/test_preflight.py',
    ),
    'two controllers': Barrier(
        'src/lta_flight/lta_flight/preflight.py', '    check_controllers(plan)\n', '',
        'test/unit/flight/test_preflight.py',
    ),
    'two bridges': Barrier(
        f'{BRIDGE}/crazyflie/drone_lock.py', 'self._socket.bind(name)', "self._socket.bind('')",
        f'{UNIT}/test_bridge_lock.py',
    ),
    'a setpoint beyond the room': Barrier(
        f'{BRIDGE}/crazyflie/bridge_core.py',
        'max(0.0, min(self.limits.height, command.height))', 'command.height',
        f'{UNIT}/test_bridge.py',
    ),
    'no number': Barrier(
        f'{BRIDGE}/crazyflie/bridge_core.py', 'elif not all(map(math.isfinite, numbers)):',
        'elif False:', f'{UNIT}/test_bridge.py',
    ),
    'duties expire on board': Barrier(
        'firmware/crazyflie/src/lta_duties.c',
        'return now_ms - duties->since_ms < duties->hold_ms;',
        '(void)now_ms; return duties->known;', f'{UNIT}/test_crazyflie_app.py',
    ),
    'watchdog': Barrier(
        f'{BRIDGE}/crazyflie/bridge_core.py',
        'self._guarded |= self._watchdog and bool(order.arm)', 'self._guarded = False',
        f'{UNIT}/test_bridge.py',
    ),
    'motors that turn without a command': Barrier(
        f'{BRIDGE}/crazyflie/connection_manager.py', 'link.write_parameter(name, 0.0, CONFIRM)',
        'pass', f'{UNIT}/test_crazyflie_link.py',
    ),
    'old command': Barrier(
        f'{BRIDGE}/crazyflie/safety.py', 'if inputs.command_age > STALE:', 'if False:',
        f'{UNIT}/test_safety.py',
    ),
    'command of the future': Barrier(
        'src/lta_graph/lta_graph/health.py',
        'return passed if passed >= -CLOCK_TOLERANCE else math.inf',
        'return passed', f'{UNIT}/test_crazyflie_cores.py',
    ),
    'low cell': Barrier(
        f'{BRIDGE}/crazyflie/safety.py', 'if now - state.low_since >= LOW_VOLTAGE_TIME:',
        'if False:', f'{UNIT}/test_safety.py',
    ),
    'low cell before arming': Barrier(
        f'{BRIDGE}/crazyflie/safety.py', 'if inputs.voltage < limits.voltage:', 'if False:',
        f'{UNIT}/test_safety.py',
    ),
    'typed name': Barrier(
        'src/lta_cli/lta_cli/verbs/hardware.py',
        'if sys.stdin.readline().strip() != answer:', 'if False:',
        'test/unit/bridge/hardware/test_motor.py',
    ),
    'emergency stop': Barrier(
        f'{BRIDGE}/crazyflie/safety.py', 'if request.stop:', 'if False:', f'{UNIT}/test_safety.py',
    ),
}  # fmt: skip


@pytest.mark.parametrize('name', BARRIERS)
def test_a_barrier_is_where_it_was(name):
    """Cheap: the long test below takes it out."""
    barrier = BARRIERS[name]
    assert (ROOT / barrier.source).read_text(encoding='utf-8').count(barrier.text) == 1
    assert (ROOT / barrier.test).is_file()


def test_the_table_names_tests_that_are_there_and_those_of_the_barriers():
    page = (ROOT / 'docs/hardware.md').read_text(encoding='utf-8')
    table = page[page.index('## Hazards') : page.index('## First flight')]
    named = set(re.findall(r'(test_\w+\.py)', table))
    assert named <= {path.name for path in (ROOT / 'test').rglob('test_*.py')}
    assert {Path(barrier.test).name for barrier in BARRIERS.values()} <= named


@pytest.fixture(scope='module')
def copy(tmp_path_factory):
    """Return a copy of the tree in which a barrier can be taken out."""
    kernels = Path(os.environ.get('XDG_CACHE_HOME') or Path.home() / '.cache') / 'lta/kernels'
    return Copy(ROOT, tmp_path_factory.mktemp('tree') / 'copy', kernels)


@pytest.mark.long
@pytest.mark.parametrize('name', BARRIERS)
def test_without_a_barrier_its_test_fails(name, copy):
    barrier = BARRIERS[name]
    text = (ROOT / barrier.source).read_text(encoding='utf-8')
    without = text.replace(barrier.text, barrier.without)
    fate, failed = copy.try_text(
        Path(barrier.source), without, [barrier.test], LIMIT, compiled=True
    )
    assert (fate, failed.partition('::')[0]) == (KILLED, barrier.test)
    assert '::' in failed  # a test of it, not its imports
