"""
Count the intact frames of a damaged stream that our search and pymavlink's own parser find.

Run as `python test/score/mutated_frames.py`. Every tenth frame of the light board's stream is
cut, gets a flipped bit, or is followed by bytes that look like the start of a frame. pymavlink
decodes what either finds.
"""

from collections.abc import Callable, Iterator
from importlib import metadata
import json
from pathlib import Path
import random
import sys
import time

from lta_bridge.teensy.frame_parser import FrameParser
from lta_bridge.teensy.mavlink import MAVLink, MAVLink_lta_light_block_message
import numpy as np

RECORD = Path(__file__).resolve().parents[1] / 'golden/mutated_frames.json'
FRAMES, CHUNK = 20_000, 512


def damaged_stream(seed: int) -> tuple[bytes, int]:
    """Return a stream, and how many of its frames are intact."""
    chance, rows = random.Random(seed), np.random.default_rng(seed)
    stream, intact, link = bytearray(), 0, MAVLink(None, 1, 191)
    for turn in range(FRAMES):
        samples = rows.integers(0, 4096, 120).tolist()
        link.seq = turn % 256
        frame = MAVLink_lta_light_block_message(turn * 1500, turn * 15, 8, 15, samples).pack(link)
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
        intact += 1
    return bytes(stream), intact


def split_stream(stream: bytes) -> Iterator[bytes]:
    """Yield the stream as a port would."""
    return (stream[at : at + CHUNK] for at in range(0, len(stream), CHUNK))


def pymavlink_frames(stream: bytes) -> int:
    """Return how many blocks pymavlink's own parser finds."""
    parser = MAVLink(None)
    parser.robust_parsing = True
    return sum(
        isinstance(message, MAVLink_lta_light_block_message)
        for chunk in split_stream(stream)
        for message in parser.parse_buffer(chunk) or ()
    )


def our_frames(stream: bytes) -> int:
    """Return how many blocks our search finds."""
    parser = FrameParser()
    return sum(
        isinstance(message, MAVLink_lta_light_block_message)
        for chunk in split_stream(stream)
        for message in parser.parse_frames(chunk)
    )


COUNTS: dict[str, Callable[[bytes], int]] = {'ours': our_frames, 'pymavlink': pymavlink_frames}


def compose_sentence() -> str:
    """Return what docs/hardware.md says, from the stored counts and times."""
    stored = json.loads(RECORD.read_text())
    ours, theirs = stored['ours'], stored['pymavlink']
    every = 'all of them' if ours['found'] == stored['intact'] else f'{ours["found"]:,}'
    return (
        f'Of {stored["frames"]:,} frames, of which every tenth was cut, got a flipped bit or was '
        'followed by bytes that look like the start of another, '
        f'{stored["intact"]:,} were intact: this search found {every}, and the parser of '
        f'pymavlink {stored["version"]} alone {theirs["found"]:,}, at '
        f'{ours["microseconds"]:.0f} and {theirs["microseconds"]:.0f} us of processor time a '
        'frame (`python test/score/mutated_frames.py`).'
    )


def main() -> None:
    """Store the counts and the processor times, and print the sentence of docs/hardware.md."""
    stream, intact = damaged_stream(1)
    stored = {'frames': FRAMES, 'intact': intact, 'version': metadata.version('pymavlink')}
    for name, count in COUNTS.items():
        began = time.process_time()
        found = count(stream)
        spent = time.process_time() - began
        stored[name] = {'found': found, 'microseconds': round(1e6 * spent / FRAMES, 1)}
    RECORD.write_text(json.dumps(stored) + '\n')
    sys.stdout.write(compose_sentence() + '\n')


if __name__ == '__main__':
    main()
