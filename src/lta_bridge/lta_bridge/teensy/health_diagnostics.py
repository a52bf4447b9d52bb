"""Describe the health of the light board and its link for diagnostics."""

from lta_bridge.teensy.light_board import LightBoard
from lta_bridge.teensy.reader import BoardReader
from lta_graph.health import HealthFact, HealthLevel

LIGHT_BOARD_TASK = 'light board'
SILENT_NS = 500_000_000  # silence that counts as an error: five blocks


def describe_health(reader: BoardReader | None, now_ns: int, active: bool) -> HealthFact:
    """Return the health at a host time [ns]; without a reader it is not configured."""
    if reader is None:
        return HealthFact(LIGHT_BOARD_TASK, HealthLevel.WARN, 'not configured')
    level, message = _assess_health(reader, now_ns, active)
    return HealthFact(
        LIGHT_BOARD_TASK, level, message, _collect_diagnostic_values(reader, reader.board)
    )


def _assess_health(reader: BoardReader, now_ns: int, active: bool) -> tuple[HealthLevel, str]:
    board = reader.board
    if reader.trouble:
        return HealthLevel.ERROR, reader.trouble
    if not board.heard_ns:
        return HealthLevel.WARN, 'nothing received yet'
    if now_ns - board.heard_ns > SILENT_NS:
        return HealthLevel.ERROR, (
            f'no data from the light board for {1e-9 * (now_ns - board.heard_ns):.1f} s'
        )
    if board.fault:
        return HealthLevel.ERROR, board.fault
    if not board.clock.is_synchronized:
        return HealthLevel.WARN, 'the clock of the light board is not synchronized yet'
    return HealthLevel.OK, 'receiving light' if active else 'receiving light, not publishing'


def _collect_diagnostic_values(reader: BoardReader, board: LightBoard) -> dict[str, str]:
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
    if clock.is_synchronized:
        figures['drift_ppm'] = f'{1e6 * clock.drift:.1f}'
        figures['uncertainty_ms'] = f'{1e3 * clock.uncertainty:.3f}'
        figures['round_trip_ms'] = f'{1e-6 * clock.round_trip:.3f}'
    return {key: str(value) for key, value in figures.items()}
