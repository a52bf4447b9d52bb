# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read a MATLAB file in a process of its own.

SciPy reads nested variables by recursion in C: a few thousand levels overflow the stack and end
the process. So the arrays come from a child, as an archive of NumPy.
"""

from collections.abc import Iterator
import json
from pathlib import Path
import resource
import signal
import subprocess
import sys
import tempfile
from typing import Any

from lta_config.errors import BadInput
from lta_config.limits import check_column_count, limit_memory
import numpy as np
from numpy.typing import NDArray

REFUSED_STATUS = 2  # exit status of the child after one sentence on stderr
NAMES_ARRAY = 'names'  # the array with the names of the others, as JSON


def read_mat_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """
    Return the arrays of a MATLAB file by dotted name; those without numbers are empty.

    Raise `BadInput` if it cannot be read, or the reader crashes.
    """
    command = [sys.executable, '-P', '-m', __name__, str(path)]
    with tempfile.TemporaryFile() as stream:
        done = subprocess.run(command, stdout=stream, stderr=subprocess.PIPE, check=False)
        if done.returncode == REFUSED_STATUS:
            raise BadInput(done.stderr.decode(errors='replace').strip())
        if done.returncode:
            raise BadInput(
                f"'{path}' cannot be read as a MATLAB file ({_describe_failure(done)}); it is "
                'damaged, or its variables are nested too deeply: copy it again, or save vectors '
                'of numbers.'
            )
        stream.seek(0)
        content = np.load(stream, allow_pickle=False)
        names = json.loads(content[NAMES_ARRAY].tobytes())
        return {name: content[f'a{index}'] for index, name in enumerate(names)}


def _describe_failure(done: subprocess.CompletedProcess[bytes]) -> str:
    """Return why the child failed."""
    if done.returncode < 0:
        return f'its reader was ended by {signal.Signals(-done.returncode).name}'
    # The last line of a traceback is the error
    last = done.stderr.decode(errors='replace').strip().rpartition('\n')[2]
    return last.partition(': ')[2].rstrip('.')[:200] or last


def main(path: Path) -> None:
    """Write the arrays of a MATLAB file to stdout; this is the child."""
    # Import here: loading scipy.io takes a tenth of a second, and few imports need it.
    from scipy.io import loadmat

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # a crash leaves no file
    with limit_memory():
        content = loadmat(path, simplify_cells=True)
        variables = {key: value for key, value in content.items() if not key.startswith('__')}
        arrays = dict(_flatten(variables))
        try:
            check_column_count(path, len(arrays))
        except BadInput as error:
            sys.stderr.write(str(error))
            sys.exit(REFUSED_STATUS)
        names = np.frombuffer(json.dumps(list(arrays)).encode(), np.uint8)
        numbered = {f'a{index}': array for index, array in enumerate(arrays.values())}
        np.savez(sys.stdout.buffer, allow_pickle=False, **{NAMES_ARRAY: names}, **numbered)


def _flatten(content: dict[str, Any], prefix: str = '') -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield the arrays of nested structs by dotted name."""
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _flatten(value, f'{prefix}{name}.')
        else:
            # Cells of several lengths are no array
            numeric = isinstance(value, np.ndarray | np.generic) and value.dtype.kind in 'fiub'
            yield prefix + name, np.asarray(value) if numeric else np.empty(0)


if __name__ == '__main__':
    main(Path(sys.argv[1]))
