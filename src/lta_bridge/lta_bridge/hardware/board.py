"""Listen to a light board for a while: the link, its clock, and each diode."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
import time
from typing import Final, final

from lta_bridge.hardware.check_result import HardwareCheck
from lta_bridge.teensy.light_board import LightBlock, LightBoard, LightPeaks
from lta_bridge.teensy.reader import BoardReader
from lta_config.schema.vehicle_diodes import DiodesBlock
from lta_config.topics import AdcBlockShape
from lta_vlc.demodulation import demodulate_block
from lta_vlc.faults import SPOILT
from lta_vlc.spectral.bins import BeaconBins
import numpy as np

PAUSE: Final = 0.05  # s between two looks at the clock


@final
@dataclass(frozen=True, slots=True)
class DiodeMeasurement:
    """One diode: mean, least and largest reading [counts], SNR of the beacon, and its faults."""

    mean: float
    least: int
    largest: int
    snr: float
    faults: tuple[str, ...]
    spoilt: bool


@final
@dataclass(frozen=True, slots=True)
class BoardMeasurement:
    """
    What a light board told.

    Attributes
    ----------
    port : str
        Where it hangs.
    rate : float
        Rows a second that came. [Hz]
    rows, lost, overruns : int
        Rows that came, that the link lost, and that the board itself had to leave.
    frames, crc_errors, unknown : int
        Messages that came whole, torn, and of no kind that we know.
    round_trip, drift, uncertainty : float or None
        Of its clock [s, 1, s]; None before it has answered.
    wrong : str
        Why its blocks cannot be used; empty where they can.
    trouble : str
        Why the link is gone; empty where it is not.
    diodes : tuple of DiodeHeard
        Counter-clockwise from the nose.

    """

    port: str
    rate: float
    rows: int
    lost: int
    overruns: int
    frames: int
    crc_errors: int
    unknown: int
    round_trip: float | None
    drift: float | None
    uncertainty: float | None
    wrong: str
    trouble: str
    diodes: tuple[DiodeMeasurement, ...]


def measure_board(
    port: str,
    light: AdcBlockShape,
    diodes: DiodesBlock,
    bins: BeaconBins,
    seconds: float,
    tick: Callable[[float], None],
) -> BoardMeasurement:
    """
    Return what a board tells.

    Parameters
    ----------
    port : str
        As for `open_port`.
    light : Light
        What a block is.
    diodes : Diodes
        Those of the vehicle file.
    bins : Bins
        Where the beacon stands in a block.
    seconds : float
        How long to listen. [s]
    tick : callable
        Told how long it has been. [s]

    Raises
    ------
    BadInput
        If the port cannot be opened.

    """
    board = LightBoard(light, diodes.count, bits=diodes.bits)
    blocks: list[LightBlock] = []

    def keep_block(block: LightBlock | LightPeaks) -> None:
        if isinstance(block, LightBlock):
            blocks.append(block)

    reader = BoardReader(port, board, keep_block, time.time_ns)
    began = time.monotonic()
    try:
        while (been := time.monotonic() - began) < seconds:
            tick(been)
            time.sleep(min(PAUSE, seconds - been))
    finally:
        reader.close()
    clock, framing, rows = board.clock, board.framing, board.blocks
    return BoardMeasurement(
        port=port,
        rate=rows.rows / seconds,
        rows=rows.rows,
        lost=rows.lost,
        overruns=board.overruns,
        frames=framing.frames,
        crc_errors=framing.crc_errors,
        unknown=framing.unknown,
        round_trip=1e-9 * clock.round_trip if clock.is_synchronized else None,
        drift=clock.drift if clock.is_synchronized else None,
        uncertainty=clock.uncertainty if clock.is_synchronized else None,
        wrong=board.fault,
        trouble=reader.trouble,
        diodes=tuple(measure_diodes(blocks, bins, diodes.largest_reading)),
    )


def measure_diodes(
    blocks: Sequence[LightBlock], bins: BeaconBins, top: float
) -> Iterator[DiodeMeasurement]:
    """
    Yield what blocks say of each diode: extremes over all, the median SNR, every fault.

    Parameters
    ----------
    blocks : sequence of LightBlock
        What the board sent.
    bins : Bins
        Where the beacon stands in a block.
    top : float
        Largest reading of the converter. [counts]

    """
    if not blocks:
        return
    heard = [demodulate_block(block.samples, (bins,), top) for block in blocks]
    samples = np.stack([block.samples for block in blocks])
    snr = np.median([each.peaks[0].snr for each in heard], axis=0)
    for k in range(samples.shape[2]):
        faults = [each.faults[k] for each in heard]
        named = {flag.name for fault in faults for flag in fault if flag.name}
        one = samples[:, :, k]
        yield DiodeMeasurement(
            float(one.mean()), int(one.min()), int(one.max()), float(snr[k]),
            tuple(sorted(name.lower().replace('_', ' ') for name in named)),
            any(fault & SPOILT for fault in faults),
        )  # fmt: skip


def judge_board(
    measurement: BoardMeasurement, light: AdcBlockShape, threshold: float
) -> Iterator[HardwareCheck]:
    """Yield what is to be said of a light board, the most fundamental first."""
    if not measurement.frames:
        why = measurement.trouble or 'nothing came'
        remedy = 'Flash firmware/light_board, and see that the port is that of the board.'
        yield HardwareCheck('light board', 'fail', f'{measurement.port}: {why}', remedy)
        return
    if measurement.wrong:
        yield HardwareCheck('light board', 'fail', measurement.wrong)
    yield _judge_rows(measurement, light.sample_rate.si)
    yield _judge_clock(measurement)
    yield _judge_diodes(measurement.diodes, threshold)


def _judge_rows(measurement: BoardMeasurement, nominal_rate: float) -> HardwareCheck:
    found = (
        f'{measurement.rate:.0f} rows a second of {nominal_rate:.0f}, {measurement.lost} lost on '
        f'the way, '
        f'{measurement.overruns} on the board, {measurement.crc_errors} torn frames'
    )
    if measurement.lost or measurement.overruns or measurement.crc_errors:
        return HardwareCheck('light', 'warn', found, 'Try a shorter cable, or another USB port.')
    return HardwareCheck('light', 'ok', found)


def _judge_clock(measurement: BoardMeasurement) -> HardwareCheck:
    if (
        measurement.round_trip is None
        or measurement.drift is None
        or measurement.uncertainty is None
    ):
        return HardwareCheck("board's clock", 'fail', 'it answers no question', 'Flash it anew.')
    return HardwareCheck(
        "board's clock", 'ok',
        f'{1e6 * measurement.drift:.0f} ppm slow, known to {1e6 * measurement.uncertainty:.0f} '
        f'us; '
        f'{1e3 * measurement.round_trip:.2f} ms there and back',
    )  # fmt: skip


def _judge_diodes(diodes: Sequence[DiodeMeasurement], threshold: float) -> HardwareCheck:
    if not diodes:
        return HardwareCheck('diodes', 'fail', 'no whole block came', 'Check again for longer.')
    spoilt = [str(k + 1) for k, each in enumerate(diodes) if each.spoilt]
    if spoilt:
        remedy = 'Flat: look at its wires. Saturated: shade it, or choose a smaller resistor.'
        return HardwareCheck(
            'diodes', 'fail', f'{", ".join(spoilt)} of {len(diodes)} are spoilt', remedy
        )
    best = max(each.snr for each in diodes)
    if best < threshold:
        return HardwareCheck(
            'diodes', 'warn', f'all {len(diodes)} read light, none hears the lamp',
            'Switch the lamp on, and give its --frequency.',
        )  # fmt: skip
    return HardwareCheck(
        'diodes', 'ok', f'all {len(diodes)} read light, SNR of the best {best:.0f}'
    )
