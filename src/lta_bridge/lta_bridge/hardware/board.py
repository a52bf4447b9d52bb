# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Measure and judge a light board: its link, clock and diodes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
import time
from typing import Final, final

from lta_bridge.hardware.check_result import assess_vehicle, HardwareCheck
from lta_bridge.teensy.light_board import LightBlock, LightBoard, LightPeaks
from lta_bridge.teensy.reader import BoardReader
from lta_config.schema.vehicle_diodes import PhotodiodesBlock
from lta_config.topics import AdcBlockShape
from lta_vlc.demodulation import demodulate_block, UNUSABLE_FAULTS
from lta_vlc.spectral.spectrum import BeaconBins
import numpy as np

PAUSE: Final = 0.05  # s between two progress updates


@final
@dataclass(frozen=True, slots=True)
class DiodeMeasurement:
    """One diode: mean, smallest and largest reading [counts], SNR of the beacon, and faults."""

    mean: float
    least: int
    largest: int
    snr: float
    faults: tuple[str, ...]
    spoilt: bool


@final
@dataclass(frozen=True, slots=True)
class BoardMeasurement:
    """Measurements of a light board."""

    port: str
    rate: float  # rate of received rows [Hz]
    # Rows received, lost on the link, and dropped by the board
    rows: int
    lost: int
    overruns: int
    # Messages received whole, damaged, and of unknown type
    frames: int
    crc_errors: int
    unknown: int
    # Of the board's clock [s, 1, s]; None before its first answer
    round_trip: float | None
    drift: float | None
    uncertainty: float | None
    wrong: str  # why the blocks cannot be used; empty if they can
    trouble: str  # why the link is down; empty if it is up
    # Of its firmware: commit, and hash of the diodes; 0 is unknown
    commit: int
    vehicle: int
    diodes: tuple[DiodeMeasurement, ...]  # counter-clockwise from the nose


def measure_board(
    port: str,
    light: AdcBlockShape,
    diodes: PhotodiodesBlock,
    bins: BeaconBins,
    seconds: float,
    tick: Callable[[float], None],
) -> BoardMeasurement:
    """
    Read a board for some time and return the measurements.

    Parameters
    ----------
    port : str
        See `open_port`.
    light : AdcBlockShape
        Layout of a block.
    diodes : PhotodiodesBlock
        Diodes of the vehicle file.
    bins : BeaconBins
        Frequency bins of the beacon in a block.
    seconds : float
        Duration. [s]
    tick : callable
        Called with the elapsed time. [s]

    Raises
    ------
    BadInput
        If the port cannot be opened.

    """
    board = LightBoard(light, diodes.count, bits=diodes.bits)
    blocks: list[LightBlock] = []

    def store_block(block: LightBlock | LightPeaks) -> None:
        if isinstance(block, LightBlock):
            blocks.append(block)

    reader = BoardReader(port, board, store_block, time.time_ns)
    began = time.monotonic()
    try:
        while (elapsed := time.monotonic() - began) < seconds:
            tick(elapsed)
            time.sleep(min(PAUSE, seconds - elapsed))
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
        commit=board.commit,
        vehicle=board.vehicle,
        diodes=tuple(measure_diodes(blocks, bins, diodes.largest_reading)),
    )


def measure_diodes(
    blocks: Sequence[LightBlock], bins: BeaconBins, top: float
) -> Iterator[DiodeMeasurement]:
    """
    Yield mean, extremes, median SNR and all faults of each diode over the blocks.

    `top` is the largest reading of the converter. [counts]
    """
    if not blocks:
        return
    results = [demodulate_block(block.samples, (bins,), top) for block in blocks]
    # Shape (blocks, samples, diodes)
    samples = np.stack([block.samples for block in blocks])
    snr = np.median([each.peaks[0].snr for each in results], axis=0)
    for k in range(samples.shape[2]):
        faults = [each.faults[k] for each in results]
        named = {flag.name for fault in faults for flag in fault if flag.name}
        one = samples[:, :, k]
        yield DiodeMeasurement(
            float(one.mean()), int(one.min()), int(one.max()), float(snr[k]),
            tuple(sorted(name.lower().replace('_', ' ') for name in named)),
            any(fault & UNUSABLE_FAULTS for fault in faults),
        )  # fmt: skip


def assess_board(
    measurement: BoardMeasurement, light: AdcBlockShape, threshold: float, vehicle: int
) -> Iterator[HardwareCheck]:
    """Yield the checks of a light board, the most fundamental first; `vehicle` is the hash."""
    if not measurement.frames:
        why = measurement.trouble or 'no data received'
        remedy = 'Flash firmware/light_board, and check that this is the port of the light board.'
        yield HardwareCheck('light board', 'fail', f'{measurement.port}: {why}', remedy)
        return
    if measurement.wrong:
        yield HardwareCheck('light board', 'fail', measurement.wrong)
    yield assess_vehicle("board's vehicle", measurement.commit, measurement.vehicle, vehicle)
    yield _assess_rows(measurement, light.sample_rate.si)
    yield _assess_clock(measurement)
    yield _assess_diodes(measurement.diodes, threshold)


def _assess_rows(measurement: BoardMeasurement, nominal_rate: float) -> HardwareCheck:
    finding = (
        f'{measurement.rate:.0f} of {nominal_rate:.0f} sample rows per second; {measurement.lost} '
        f'lost on the link, {measurement.overruns} lost on the board; {measurement.crc_errors} '
        'damaged frames'
    )
    if measurement.lost or measurement.overruns or measurement.crc_errors:
        return HardwareCheck('light', 'warn', finding, 'Try a shorter cable, or another USB port.')
    return HardwareCheck('light', 'ok', finding)


def _assess_clock(measurement: BoardMeasurement) -> HardwareCheck:
    if (
        measurement.round_trip is None
        or measurement.drift is None
        or measurement.uncertainty is None
    ):
        return HardwareCheck(
            "board's clock", 'fail', 'the light board does not answer time requests',
            'Flash the firmware of the light board again.',
        )  # fmt: skip
    return HardwareCheck(
        "board's clock", 'ok',
        f'runs {1e6 * measurement.drift:.0f} ppm slow; its time is known with a standard '
        f'deviation of {1e6 * measurement.uncertainty:.0f} us; '
        f'round trip {1e3 * measurement.round_trip:.2f} ms',
    )  # fmt: skip


def _assess_diodes(diodes: Sequence[DiodeMeasurement], threshold: float) -> HardwareCheck:
    if not diodes:
        return HardwareCheck(
            'diodes', 'fail', 'no complete block of photodiode samples received',
            'Repeat the check with a longer --seconds.',
        )  # fmt: skip
    spoilt = [str(k + 1) for k, each in enumerate(diodes) if each.spoilt]
    if spoilt:
        remedy = (
            'If its reading is constant, check the wires. If it is saturated, shade the '
            'photodiode, or choose a smaller resistor.'
        )
        return HardwareCheck(
            'diodes', 'fail',
            f'constant or saturated signal: photodiodes {", ".join(spoilt)} of {len(diodes)}',
            remedy,
        )  # fmt: skip
    best = max(each.snr for each in diodes)
    # One diode suffices: the others may face away from the beacon
    if best < threshold:
        return HardwareCheck(
            'diodes', 'warn', f'all {len(diodes)} photodiodes work, but none detects the lamp',
            'Switch the lamp on, and give its modulation frequency with --frequency.',
        )  # fmt: skip
    return HardwareCheck(
        'diodes', 'ok', f'all {len(diodes)} photodiodes work; best SNR {best:.0f}'
    )
