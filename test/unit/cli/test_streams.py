"""What nobody reads any more is dropped without a word."""

import os

from lta_cli.streams import BrokenPipeFile, wrap_stream
import pytest


def test_a_closed_pipe_takes_everything():
    reading, writing = os.pipe()
    with os.fdopen(writing, 'w') as plain:
        stream = wrap_stream(plain)
        stream.write('heard\n')
        assert os.read(reading, 100) == b'heard\n'
        os.close(reading)
        for _ in range(3):
            stream.write(100_000 * 'x' + '\n')
        stream.close()
        assert os.fstat(writing), 'the descriptor is not ours to close'


def test_a_full_disk_is_no_closed_pipe():
    with BrokenPipeFile('/dev/full', 'w') as full, pytest.raises(OSError, match='No space left'):
        full.write(b'x')
