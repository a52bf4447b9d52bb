"""
Table of the log blocks that the bridge reads from a Crazyflie.

Names, types and units are the firmware's. Limits (firmware, log.c): 26 bytes of values per block,
periods of 10 to 2540 ms in steps of 10, 16 blocks and 128 variables in total.
"""

from typing import Final, NamedTuple

from lta_config.errors import BadInput

SIZES: Final = {'float': 4, 'uint8_t': 1, 'uint16_t': 2, 'int8_t': 1, 'uint32_t': 4}
MOST_BYTES: Final = 26
MOST_BLOCKS: Final = 16
MOST_VARIABLES: Final = 128
SHORTEST_MS, LONGEST_MS, STEP_MS = 10, 2540, 10


class LogBlock(NamedTuple):
    """A log block, sent as one packet per period; `variables` maps `group.name` to its type."""

    name: str
    period_ms: int
    variables: dict[str, str]


def _map_to_type(kind: str, *names: str) -> dict[str, str]:
    return dict.fromkeys(names, kind)


BLOCKS: Final = (
    LogBlock(
        'imu', 10, _map_to_type('float', *(f'{s}.{a}' for s in ('acc', 'gyro') for a in 'xyz'))
    ),
    LogBlock(
        'air',
        20,
        _map_to_type('float', 'baro.pressure') | _map_to_type('uint16_t', 'range.zrange'),
    ),
    LogBlock(
        'attitude',
        20,
        _map_to_type('float', *(f'stateEstimate.{a}' for a in ('roll', 'pitch', 'yaw'))),
    ),
    LogBlock(
        'motors',
        50,
        _map_to_type(
            'uint16_t', *(f'motor.m{number}' for number in range(1, 5)), 'supervisor.info'
        ),
    ),
    LogBlock('power', 100, _map_to_type('float', 'pm.vbat') | _map_to_type('int8_t', 'pm.state')),
)


def check_log_table(blocks: tuple[LogBlock, ...]) -> None:
    """
    Check a table against the limits of the firmware.

    Raise `BadInput` if a block is too large, its period is invalid, or there are too many.
    """
    for block in blocks:
        size = sum(SIZES[kind] for kind in block.variables.values())
        if size > MOST_BYTES:
            raise BadInput(
                f'Log block {block.name} has {size} bytes, above the limit of {MOST_BYTES} '
                'bytes per packet; split the block in two.'
            )
        if block.period_ms % STEP_MS or not SHORTEST_MS <= block.period_ms <= LONGEST_MS:
            raise BadInput(
                f'Log block {block.name} has a period of {block.period_ms} ms; choose a multiple '
                f'of {STEP_MS} ms from {SHORTEST_MS} ms to {LONGEST_MS} ms.'
            )
    count = sum(len(block.variables) for block in blocks)
    if len(blocks) > MOST_BLOCKS or count > MOST_VARIABLES:
        raise BadInput(
            f'There are {len(blocks)} log blocks with {count} variables, but a Crazyflie has at '
            f'most {MOST_BLOCKS} blocks and {MOST_VARIABLES} variables; leave some out.'
        )
