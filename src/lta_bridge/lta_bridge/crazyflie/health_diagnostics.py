"""Describe the health of the link and the drone for diagnostics."""

from collections.abc import Iterator

from lta_bridge.crazyflie.bridge_core import BridgeCore
from lta_bridge.crazyflie.buoyancy import BuoyancyMonitor
from lta_bridge.crazyflie.connection_manager import CONNECTING, ConnectionManager
from lta_bridge.crazyflie.safety import DELIBERATE, SafetyInputs, SafetyStage, SILENT_LINK
from lta_bridge.crazyflie.supervisor_word import explain_fault
from lta_graph.health import HealthFact, HealthLevel

NOT_CONFIGURED = 'not configured'
RISING = (
    'the drone rises without thrust, so it is lighter than air and will not land: hold the '
    'tether, and add ballast'
)
HELD_DOWN = (
    'the drone does not sink although it is pushed down, so it is lighter than air and will rise '
    'when its motors stop: hold the tether before you disarm it, and add ballast'
)


def describe_health(
    bridge: BridgeCore, why: str, attempts: int, protocol: int, inputs: SafetyInputs
) -> Iterator[HealthFact]:
    """Yield the health of link, safety, packets and commands; `why` explains a missing link."""
    yield _describe_link(bridge, why, attempts, protocol, inputs)
    yield _describe_safety(bridge, inputs)
    yield bridge.malformed.build_fact('packets', 'all can be read')
    yield bridge.unasked.build_fact('commands', 'all can be flown')


def describe_connection(keeper: ConnectionManager | None) -> tuple[str, int]:
    """Return why there is no link, empty if there is one, and the number of attempts."""
    return (NOT_CONFIGURED, 0) if keeper is None else (keeper.why, keeper.attempts)


def describe_buoyancy(buoyancy: BuoyancyMonitor) -> str:
    """Return the error of a drone that is lighter than air; empty if it is not."""
    return RISING if buoyancy.rises else HELD_DOWN if buoyancy.is_held_down else ''


def _describe_link(
    bridge: BridgeCore, why: str, attempts: int, protocol: int, inputs: SafetyInputs
) -> HealthFact:
    figures = {
        'protocol': protocol,
        'silence_s': f'{inputs.silence:.3f}',
        'latency_s': f'{bridge.trips.latency:.4f}',
        'one_way_s': f'{1e-9 * bridge.trips.one_way_ns:.4f}',
        'drift_ppm': f'{1e6 * bridge.clock.drift:.1f}',
        'clock_restarts': bridge.clock.line.restarts,
        'packets': bridge.packets,
        'attempts': attempts,
    }
    alive = inputs.linked and inputs.silence < SILENT_LINK
    silent = f'no packets for {inputs.silence:.1f} s' if inputs.linked else why
    # A start is no fault yet
    missing = HealthLevel.WARN if silent == CONNECTING else HealthLevel.ERROR
    level, message = (HealthLevel.OK, 'connected') if alive else (missing, silent)
    return HealthFact('link', level, message, {key: str(value) for key, value in figures.items()})


def _describe_safety(bridge: BridgeCore, inputs: SafetyInputs) -> HealthFact:
    state = bridge.state
    duties = () if bridge.motors is None else bridge.motors.duties
    figures = {
        'word': str(inputs.word),
        'command': bridge.command,
        'voltage': f'{inputs.voltage:.2f}',
        'motors': ' '.join(f'{duty:.2f}' for duty in duties),
    }
    level = HealthLevel.OK
    if state.stage is SafetyStage.STOPPED or explain_fault(inputs.word):
        level = HealthLevel.ERROR
    elif state.stage is SafetyStage.LANDING and state.why not in DELIBERATE:
        level = HealthLevel.WARN
    message = f'{state.stage.value}: {state.why}' if state.why else state.stage.value
    if sensor := bridge.find_stuck_sensor():
        level, message = HealthLevel.ERROR, f'{message}; the {sensor} repeats its reading'
    if warning := describe_buoyancy(bridge.buoyancy):
        level, message = HealthLevel.ERROR, f'{message}; {warning}'
    return HealthFact('safety', level, message, figures)
