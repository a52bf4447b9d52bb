"""
Counter-based random numbers: draw n of stream s of a flight is a function of (s, n).

Threefry-2x32 with 20 rounds (Salmon, Moraes, Dror and Shaw 2011, Parallel random numbers: as easy
as 1, 2, 3, doi:10.1145/2063384.2063405) needs only additions, rotations and exclusive ors of 32
bits. Each vehicle of a batch therefore has its own numbers, with the same bits in plain Python,
compiled, and on a GPU. Normal deviates use logarithm and cosine, and may differ in the last bit
between these.
"""

import math

WORD_MASK = 0xFFFFFFFF
# Key parity and rotation constants of Threefry-2x32, from the paper
PARITY = 0x1BD11BDA
ROTATIONS = (13, 15, 26, 6, 17, 29, 16, 24)
ROUND_GROUPS = 5  # of four turns each
# 2^-32
SCALE = 1.0 / 4294967296.0


def threefry(key: int, stream: int, first: int, second: int) -> tuple[int, int]:
    """
    Return 64 random bits as two 32-bit words.

    `key`, `stream`: identify the sequence; 32 bits each. `first`, `second`: counter within the
    sequence; 32 bits each.
    """
    keys = (key, stream, PARITY ^ key ^ stream)
    x, y = (first + key) & WORD_MASK, (second + stream) & WORD_MASK
    for group in range(ROUND_GROUPS):
        for k in range(4):
            turn = ROTATIONS[4 * (group % 2) + k]
            # The mask emulates 32-bit overflow, because Python's integers are unbounded
            x = (x + y) & WORD_MASK
            y = (((y << turn) & WORD_MASK) | (y >> (32 - turn))) ^ x
        # Key injection after every four rounds
        x = (x + keys[(group + 1) % 3]) & WORD_MASK
        y = (y + keys[(group + 2) % 3] + group + 1) & WORD_MASK
    return x, y


def draw_uniforms(seed: int, stream: int, turn: int, lane: int) -> tuple[float, float]:
    """
    Return two numbers uniform between 0 and 1, both excluded.

    `seed`, `stream`: seed of the flight, and number of the sensor or event. `turn`, `lane`:
    control step, and index of the draw within it.
    """
    x, y = threefry(seed, stream, turn, lane)
    # The half excludes 0, so that the logarithm of Box and Muller is finite
    return (x + 0.5) * SCALE, (y + 0.5) * SCALE


def draw_normals(seed: int, stream: int, turn: int, lane: int) -> tuple[float, float]:
    """Return two normal deviates (Box and Muller 1958); arguments as for `draw_uniforms`."""
    a, b = draw_uniforms(seed, stream, turn, lane)
    radius = math.sqrt(-2.0 * math.log(a))
    return radius * math.cos(2.0 * math.pi * b), radius * math.sin(2.0 * math.pi * b)
