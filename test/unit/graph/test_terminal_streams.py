# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is written to a terminal has no control characters, and what nobody reads is dropped."""

import io
import os
import subprocess
import sys
from unicodedata import category

from lta_graph.terminal_streams import BrokenPipeFile, TerminalStream, wrap_stream
import pytest
from rich.console import Console

# Control, direction or no width, surrogates, line and paragraph separators
FORBIDDEN = ('Cc', 'Cf', 'Cs', 'Zl', 'Zp')


@pytest.fixture
def stream():
    return TerminalStream(io.BufferedWriter(io.BytesIO()), 'utf-8')


def written(stream):
    stream.flush()
    return stream.buffer.raw.getvalue().decode()


def test_no_character_that_acts_on_a_terminal_is_written(stream):
    hostile = [chr(k) for k in range(sys.maxunicode + 1) if category(chr(k)) in FORBIDDEN]
    stream.write(''.join(hostile))
    stream.writelines(hostile)
    print(*hostile, file=stream, sep='')
    assert {c for c in written(stream) if category(c) in FORBIDDEN} == {'\n', '\t'}


def test_what_people_read_stays(stream):
    text = 'Grüße, 飛行船 ─│┐ ⠓ 3 m² ±0.5 °\t→\n'
    stream.write(text)
    assert written(stream) == text


def test_colours_of_rich_stay_in_their_place(stream):
    """Another stream with a text wrapper of its own could write in another order."""
    console = Console(file=stream, force_terminal=True, color_system='standard')
    stream.write('a \x1b[31m')
    console.print('b', style='red', end='')
    stream.write('c')
    assert written(stream) == 'a \ufffd[31m\x1b[31mb\x1b[0mc'


def test_characters_that_the_encoding_lacks_are_no_error():
    stream = TerminalStream(io.BufferedWriter(io.BytesIO()), 'ascii')
    stream.write('3 m²\n')
    Console(file=stream).print('│ 5 °')
    assert written(stream) == '3 m?\n? 5 ?\n'


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


def test_stdout_is_reserved_for_what_the_process_itself_writes():
    """As JSON, beside which DDS writes its errors to the same descriptor."""
    program = (
        'import os, sys\n'
        'from lta_graph.terminal_streams import guard_streams, reserve_stdout\n'
        'guard_streams()\n'
        'reserve_stdout()\n'
        'os.write(1, b"of a library\\n")\n'
        'sys.stdout.write("{}\\n")\n'
    )
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, check=True)
    assert (done.stdout, done.stderr) == (b'{}\n', b'of a library\n')
