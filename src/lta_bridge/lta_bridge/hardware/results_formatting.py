"""Format the results of a hardware check as tables and as JSON."""

from collections.abc import Sequence
from dataclasses import asdict
import math
from typing import Any

from lta_bridge.hardware.board import DiodeMeasurement
from lta_bridge.hardware.check import HardwareCheckReport
from lta_bridge.hardware.stream import StreamStatistics


def format_stream_rows(streams: Sequence[StreamStatistics]) -> list[tuple[str, ...]]:
    """Return the table of log blocks; the first row is the header."""
    head: tuple[str, ...] = ('block', 'rate [Hz]', 'wanted [Hz]', 'lost [%]', 'jitter [ms]')
    return [head, *(
        (
            each.name, f'{each.rate:.1f}', f'{each.requested_rate:.0f}', f'{1e2 * each.loss:.2f}',
            f'{1e3 * each.jitter:.1f}',
        )
        for each in streams
    )]  # fmt: skip


def format_diode_rows(diodes: Sequence[DiodeMeasurement]) -> list[tuple[str, ...]]:
    """Return the table of diodes; the first row is the header."""
    head: tuple[str, ...] = ('diode', 'mean', 'least', 'largest', 'SNR', 'fault')
    return [head, *(
        (
            str(k), f'{each.mean:.0f}', str(each.least), str(each.largest), f'{each.snr:.1f}',
            ', '.join(each.faults) or 'none',
        )
        for k, each in enumerate(diodes, start=1)
    )]  # fmt: skip


def to_json(outcome: HardwareCheckReport) -> dict[str, Any]:
    """Return the report for JSON; NaN and infinity become null."""
    return {
        'checks': [asdict(check) for check in outcome.checks],
        'drone': None if outcome.drone is None else _to_json_value(asdict(outcome.drone)),
        'light_board': None if outcome.board is None else _to_json_value(asdict(outcome.board)),
    }


def _to_json_value(value: Any) -> Any:  # noqa: ANN401 - whatever JSON holds
    match value:
        case float():
            return value if math.isfinite(value) else None
        case dict():
            return {name: _to_json_value(one) for name, one in value.items()}
        case tuple() if hasattr(value, '_asdict'):
            return _to_json_value(value._asdict())
        case list() | tuple():
            return [_to_json_value(one) for one in value]
    return value
