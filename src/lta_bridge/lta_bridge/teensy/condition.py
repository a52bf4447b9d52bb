"""How the light board and its link are, as one fact with the figures behind it."""

from lta_bridge.teensy.light_board import LightBoard
from lta_bridge.teensy.reader import Reader
from lta_graph.health import Fact, Level

TASK = 'light board'
SILENT_NS = 500_000_000  # without a frame: five blocks


def condition(reader: Reader | None, now_ns: int, active: bool) -> Fact:
    """Return how the board is at a time of ours [ns]; without a reader nothing is configured."""
    if reader is None:
        return Fact(TASK, Level.WARN, 'not configured')
    level, message = _standing(reader, now_ns, active)
    return Fact(TASK, level, message, _figures(reader, reader.board))


def _standing(reader: Reader, now_ns: int, active: bool) -> tuple[Level, str]:
    board = reader.board
    if reader.trouble:
        return Level.ERROR, reader.trouble
    if not board.heard_ns:
        return Level.WARN, 'nothing has come yet'
    if now_ns - board.heard_ns > SILENT_NS:
        return Level.ERROR, f'silent for {1e-9 * (now_ns - board.heard_ns):.1f} s'
    if board.wrong:
        return Level.ERROR, board.wrong
    if not board.clock.known:
        return Level.WARN, 'its time is not known yet'
    return Level.OK, 'light comes' if active else 'light comes and is not published'


def _figures(reader: Reader, board: LightBoard) -> dict[str, str]:
    framing, blocks, clock = board.framing, board.blocks, board.clock
    figures: dict[str, object] = {
        'frames': framing.frames,
        'crc_errors': framing.crc_errors,
        'unknown': framing.unknown,
        'stray_bytes': framing.stray,
        'blocks': blocks.whole,
        'blocks_torn': blocks.torn,
        'rows_lost': blocks.lost,
        'rows_old': blocks.old,
        'undated': board.undated,
        'unfit': board.unfit,
        'of_other_systems': board.sender.others,
        'of_other_senders': reader.strangers,
        'unanswered': board.unanswered,
        'overruns': board.overruns,
        'peaks': board.peaks,
        'unplugged': reader.unplugged,
        'restarts': clock.restarts,
    }
    if clock.known:
        figures['drift_ppm'] = f'{1e6 * clock.drift:.1f}'
        figures['uncertainty_ms'] = f'{1e3 * clock.uncertainty:.3f}'
        figures['round_trip_ms'] = f'{1e-6 * clock.round_trip:.3f}'
    return {key: str(value) for key, value in figures.items()}
