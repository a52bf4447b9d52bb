"""One bridge to a drone: who has it holds a lock that ends with its process."""

import fcntl
import hashlib
import os
from pathlib import Path
import tempfile
from typing import final, IO

from lta_config.errors import BadInput


@final
class Claim:
    """
    The right to command one drone from this machine.

    Parameters
    ----------
    uri : str
        Which.

    Raises
    ------
    BadInput
        If another process has it.

    """

    def __init__(self, uri: str) -> None:
        name = hashlib.sha256(uri.encode()).hexdigest()[:16]
        path = Path(tempfile.gettempdir()) / f'lta-crazyflie-{name}.lock'
        self._file: IO[str] | None = path.open('a+')
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self._file.seek(0)
            holder = self._file.read().strip() or 'unknown'
            self._file.close()
            raise BadInput(
                f'{uri} is commanded by another program (process {holder}); end that one, since a '
                'drone obeys whoever spoke last.'
            ) from None
        self._file.truncate(0)
        self._file.write(str(os.getpid()))
        self._file.flush()

    def close(self) -> None:
        """Give the drone free; again is harmless."""
        if self._file is not None:
            self._file.close()
            self._file = None
