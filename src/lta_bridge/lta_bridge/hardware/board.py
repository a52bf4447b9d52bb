"""Listen to a light board for a while: the link, its clock, and each diode."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
import time
from typing import Final, final

from lta_bridge.hardware.check_result import Check
from lta_bridge.teensy.light_board import LightBlock, LightBoard, LightPeaks
from lta_bridge.teensy.reader import Reader
from lta_config.schema.vehicle_diodes import Diodes
from lta_config.topics import Light
from lta_vlc.demodulation import hear
from lta_vlc.faults import SPOILT
from lta_vlc.spectral.bins import Bins
import numpy as np

PAUSE: Final = 0.05  # s between two looks at the clock


@final
@dataclass(frozen=True, slots=True)
class DiodeHeard:
    """One diode: mean, least and largest reading [counts], SNR of the beacon, and its faults."""

    mean: float
    least: int
    largest: int
    snr: float
    faults: tuple[str, ...]
    spoilt: bool


@final
@dataclass(frozen=True, slots=True)
class BoardHeard:
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
    diodes: tuple[DiodeHeard, ...]


def listen(
    port: str,
    light: Light,
    diodes: Diodes,
    bins: Bins,
    seconds: float,
    tick: Callable[[float], None],
) -> BoardHeard:
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

    def keep(told: LightBlock | LightPeaks) -> None:
        if isinstance(told, LightBlock):
            blocks.append(told)

    reader = Reader(port, board, keep, time.time_ns)
    began = time.monotonic()
    try:
        while (been := time.monotonic() - began) < seconds:
            tick(been)
            time.sleep(min(PAUSE, seconds - been))
    finally:
        reader.close()
    clock, framing, rows = board.clock, board.framing, board.blocks
    return BoardHeard(
        port=port,
        rate=rows.rows / seconds,
        rows=rows.rows,
        lost=rows.lost,
        overruns=board.overruns,
        frames=framing.frames,
        crc_errors=framing.crc_errors,
        unknown=framing.unknown,
        round_trip=1e-9 * clock.round_trip if clock.known else None,
        drift=clock.drift if clock.known else None,
        uncertainty=clock.uncertainty if clock.known else None,
        wrong=board.wrong,
        trouble=reader.trouble,
        diodes=tuple(of_diodes(blocks, bins, diodes.top)),
    )


def of_diodes(blocks: Sequence[LightBlock], bins: Bins, top: float) -> Iterator[DiodeHeard]:
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
    heard = [hear(block.samples, (bins,), top) for block in blocks]
    samples = np.stack([block.samples for block in blocks])
    snr = np.median([each.peaks[0].snr for each in heard], axis=0)
    for k in range(samples.shape[2]):
        faults = [each.faults[k] for each in heard]
        named = {flag.name for fault in faults for flag in fault if flag.name}
        one = samples[:, :, k]
        yield DiodeHeard(
            float(one.mean()), int(one.min()), int(one.max()), float(snr[k]),
            tuple(sorted(name.lower().replace('_', ' ') for name in named)),
            any(fault & SPOILT for fault in faults),
        )  # fmt: skip


def judged(heard: BoardHeard, light: Light, threshold: float) -> Iterator[Check]:
    """Yield what is to be said of a light board, the most fundamental first."""
    if not heard.frames:
        why = heard.trouble or 'nothing came'
        remedy = 'Flash firmware/light_board, and see that the port is that of the board.'
        yield Check('light board', 'fail', f'{heard.port}: {why}', remedy)
        return
    if heard.wrong:
        yield Check('light board', 'fail', heard.wrong)
    yield _rows(heard, light.sample_rate.si)
    yield _clock(heard)
    yield _diodes(heard.diodes, threshold)


def _rows(heard: BoardHeard, wanted: float) -> Check:
    found = (
        f'{heard.rate:.0f} rows a second of {wanted:.0f}, {heard.lost} lost on the way, '
        f'{heard.overruns} on the board, {heard.crc_errors} torn frames'
    )
    if heard.lost or heard.overruns or heard.crc_errors:
        return Check('light', 'warn', found, 'Try a shorter cable, or another USB port.')
    return Check('light', 'ok', found)


def _clock(heard: BoardHeard) -> Check:
    if heard.round_trip is None or heard.drift is None or heard.uncertainty is None:
        return Check("board's clock", 'fail', 'it answers no question', 'Flash it anew.')
    return Check(
        "board's clock", 'ok',
        f'{1e6 * heard.drift:.0f} ppm slow, known to {1e6 * heard.uncertainty:.0f} us; '
        f'{1e3 * heard.round_trip:.2f} ms there and back',
    )  # fmt: skip


def _diodes(diodes: Sequence[DiodeHeard], threshold: float) -> Check:
    if not diodes:
        return Check('diodes', 'fail', 'no whole block came', 'Check again for longer.')
    spoilt = [str(k + 1) for k, each in enumerate(diodes) if each.spoilt]
    if spoilt:
        remedy = 'Flat: look at its wires. Saturated: shade it, or choose a smaller resistor.'
        return Check('diodes', 'fail', f'{", ".join(spoilt)} of {len(diodes)} are spoilt', remedy)
    best = max(each.snr for each in diodes)
    if best < threshold:
        return Check(
            'diodes', 'warn', f'all {len(diodes)} read light, none hears the lamp',
            'Switch the lamp on, and give its --frequency.',
        )  # fmt: skip
    return Check('diodes', 'ok', f'all {len(diodes)} read light, SNR of the best {best:.0f}')
