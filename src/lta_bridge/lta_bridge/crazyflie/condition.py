"""How the link and the drone are, as two facts with the figures behind them."""

from collections.abc import Iterator

from lta_bridge.crazyflie.bridge import Bridge
from lta_bridge.crazyflie.keeper import Keeper
from lta_bridge.crazyflie.safety import Seen, SILENT, Stage
from lta_graph.health import Fact, Level

NOT_CONFIGURED = 'not configured'


def condition(
    bridge: Bridge, why: str, attempts: int, protocol: int, seen: Seen
) -> Iterator[Fact]:
    """Yield how link and drone are by what is known, and by why there is no link."""
    yield _link(bridge, why, attempts, protocol, seen)
    yield _safety(bridge, seen)
    yield bridge.malformed.fact('packets', 'all can be read')
    yield bridge.unasked.fact('commands', 'all can be flown')


def kept(keeper: Keeper | None) -> tuple[str, int]:
    """Return why there is no link, empty where there is one, and how often it was tried."""
    return (NOT_CONFIGURED, 0) if keeper is None else (keeper.why, keeper.attempts)


def _link(bridge: Bridge, why: str, attempts: int, protocol: int, seen: Seen) -> Fact:
    figures = {
        'protocol': protocol,
        'silence_s': f'{seen.silence:.3f}',
        'latency_s': f'{bridge.trips.most:.4f}',
        'one_way_s': f'{1e-9 * bridge.trips.one_way_ns:.4f}',
        'drift_ppm': f'{1e6 * bridge.clock.drift:.1f}',
        'clock_restarts': bridge.clock.line.restarts,
        'packets': bridge.packets,
        'attempts': attempts,
    }
    heard = seen.linked and seen.silence < SILENT
    silent = f'silent for {seen.silence:.1f} s' if seen.linked else why
    level, message = (Level.OK, 'connected') if heard else (Level.ERROR, silent)
    return Fact('link', level, message, {key: str(value) for key, value in figures.items()})


def _safety(bridge: Bridge, seen: Seen) -> Fact:
    state = bridge.state
    duties = () if bridge.motors is None else bridge.motors.duties
    figures = {
        'word': str(seen.word),
        'command': bridge.command,
        'voltage': f'{seen.voltage:.2f}',
        'motors': ' '.join(f'{duty:.2f}' for duty in duties),
    }
    level = Level.ERROR if state.stage is Stage.STOPPED else Level.OK
    message = f'{state.stage.value}: {state.why}' if state.why else state.stage.value
    return Fact('safety', level, message, figures)
