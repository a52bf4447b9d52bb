"""
Count the intact frames of a damaged stream that our parser and pymavlink's find.

Also measure pymavlink behind our parser, which hands it the intact frames one by one.
Run as `python test/score/mutated_frames.py`. Every tenth frame of the light board's stream is
cut, gets a flipped bit, or is followed by bytes that look like the start of a frame.
"""

from functools import partial
from importlib import metadata
import json
from pathlib import Path
import random
import subprocess
import sys
import tempfile
import time
from typing import Any

from lta_bridge.teensy.dialect import LTA_LIGHT_BLOCK
from lta_bridge.teensy.frame_parser import FrameParser
import numpy as np

XML = Path(__file__).resolve().parents[2] / 'firmware/light_board/mavlink/link.xml'
RECORD = Path(__file__).resolve().parents[1] / 'golden/mutated_frames.json'
FRAMES, CHUNK = 20_000, 512


def damaged_stream(seed: int) -> tuple[bytes, list[bytes]]:
    """Return a stream, and those of its frames that are intact."""
    chance, rows = random.Random(seed), np.random.default_rng(seed)
    stream, intact = bytearray(), []
    for turn in range(FRAMES):
        samples = rows.integers(0, 4096, 120)
        frame = LTA_LIGHT_BLOCK.build_frame(
            turn, 1, 191, time_usec=turn * 1500, sequence=turn * 15, diodes=8, rows=15,
            samples=samples,
        )  # fmt: skip
        if chance.random() < 0.1:
            at = chance.randrange(len(frame))
            match chance.randrange(3):
                case 0:
                    stream += frame[:at]
                    continue
                case 1:
                    stream += frame[:at] + bytes((frame[at] ^ 1 << chance.randrange(8),))
                    stream += frame[at + 1 :]
                    continue
                case _:
                    stream += frame + b'\xfd' + chance.randbytes(chance.randrange(1, 12))
        else:
            stream += frame
        intact.append(frame)
    return bytes(stream), intact


def generate_dialect() -> Any:
    """Return the dialect that mavgen writes for unmodified pymavlink."""
    with tempfile.TemporaryDirectory() as folder:
        words = ['-m', 'pymavlink.tools.mavgen', '--lang=Python3', '--wire-protocol=2.0', '-o']
        subprocess.run(
            [sys.executable, *words, f'{folder}/link.py', str(XML)], check=True,
            capture_output=True,
        )  # fmt: skip
        sys.path.insert(0, folder)
        import link  # type: ignore[import-not-found]
    return link


def pymavlink_frames(stream: bytes, link: Any) -> int:
    """Return how many blocks pymavlink finds."""
    parser = link.MAVLink(None)
    parser.robust_parsing = True
    found = 0
    for at in range(0, len(stream), CHUNK):
        messages = parser.parse_buffer(stream[at : at + CHUNK]) or []
        found += sum(one.get_type() == 'LTA_LIGHT_BLOCK' for one in messages)
    return found


def decoded_frames(frames: list[bytes], link: Any) -> int:
    """Return how many blocks pymavlink decodes from frames that our parser found."""
    parser = link.MAVLink(None)
    return sum(parser.decode(bytearray(one)).get_type() == 'LTA_LIGHT_BLOCK' for one in frames)


def our_frames(stream: bytes) -> int:
    """Return how many blocks our parser finds."""
    parser = FrameParser()
    chunks = (stream[at : at + CHUNK] for at in range(0, len(stream), CHUNK))
    return sum(
        frame.message is LTA_LIGHT_BLOCK for c in chunks for frame in parser.parse_frames(c)
    )


def compose_sentence() -> str:
    """Return what docs/hardware.md says, from the stored counts and times."""
    stored = json.loads(RECORD.read_text())
    ours, theirs = stored['ours'], stored['pymavlink']
    every = 'all of them' if ours['found'] == stored['intact'] else f'{ours["found"]:,}'
    return (
        f'Of {stored["frames"]:,} frames, of which every tenth was cut, got a flipped bit or was '
        'followed by bytes that look like the start of another, '
        f'{stored["intact"]:,} were intact: this parser found {every}, and pymavlink '
        f'{stored["version"]} found {theirs["found"]:,}, at {ours["microseconds"]:.0f} and '
        f'{theirs["microseconds"]:.0f} us of processor time a frame '
        '(`python test/score/mutated_frames.py`). Behind this parser pymavlink finds '
        f'{stored["behind"]["found"]:,}, for {stored["behind"]["microseconds"]:.0f} us more.'
    )


def main() -> None:
    """Store the counts and the processor times, and print the sentence of docs/hardware.md."""
    (stream, intact), link = damaged_stream(1), generate_dialect()
    stored = {'frames': FRAMES, 'intact': len(intact), 'version': metadata.version('pymavlink')}
    for name, count in (
        ('ours', partial(our_frames, stream)),
        ('pymavlink', partial(pymavlink_frames, stream, link)),
        ('behind', partial(decoded_frames, intact, link)),
    ):
        began = time.process_time()
        found = count()
        spent = time.process_time() - began
        stored[name] = {'found': found, 'microseconds': round(1e6 * spent / FRAMES, 1)}
    RECORD.write_text(json.dumps(stored) + '\n')
    sys.stdout.write(compose_sentence() + '\n')


if __name__ == '__main__':
    main()
