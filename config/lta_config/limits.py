"""
What LTA takes from strangers at most: files, recordings and shapes whose maker nobody knows.

Each is far beyond what an honest file needs, and low enough for a machine of 4 GB. Beyond it, a
command ends with one sentence. docs/security.md says what they are for.
"""

from typing import Final

# YAML files
YAML_BYTES: Final = 1_000_000  # no file that people write by hand comes near it
YAML_DEPTH: Final = 50  # levels; thousands of them overflow the C stack of the YAML reader
YAML_DIGITS: Final = 400  # of a number; the largest that a computer calculates with has 309

# Recordings
CHUNK_BYTES: Final = 1 << 27  # of a chunk or message, unpacked
NOTE_BYTES: Final = 1 << 24  # of a schema, channel or metadata record
CHANNELS: Final = 4000  # of a recording; the largest robots have hundreds
SUMMARY_BYTES: Final = 1 << 28  # of the directory at the end of a recording
GRID: Final = 2_000_000  # points of an even clock over it; more where it has many itself
DEFINITION_BYTES: Final = 250_000  # of the text that defines a message type
ARRAY_PARTS: Final = 4096  # of its fixed arrays of texts or messages, each of which becomes code

# Logs of others
LOG_BYTES: Final = 1 << 29  # of a log that is read whole: ULog, Crazyflie's card
LINE_BYTES: Final = 1 << 20  # of a line of text with columns
INFLATION: Final = 200  # bytes out of one byte of gzip or zstd; text with columns has up to 20
INFLATED_FREELY: Final = 1 << 26  # bytes before that counts
READER_MEMORY: Final = 1 << 31  # bytes that a reader of others may take beyond what is taken

# Shapes
STL_BYTES: Final = 150_000_000  # text; a binary file of as many triangles has a fifth
STL_TRIANGLES: Final = 500_000
