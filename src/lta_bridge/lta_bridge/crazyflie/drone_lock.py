"""One bridge to a drone: who has it holds a lock that ends with its process."""

from contextlib import suppress
import fcntl
import hashlib
import os
from pathlib import Path
import socket
import tempfile
from typing import Final, final, IO

from lta_config.errors import BadInput

AS_SOLD: Final = ('2M', 'E7E7E7E7E7')  # rate and address, where a URI leaves them out


def normalize_uri(uri: str) -> str:
    """Return one name for a drone, however its URI is written and whichever radio reaches it."""
    scheme, _, rest = uri.partition('://')
    rest = rest.partition('?')[0]
    if scheme == 'radio':
        channel, *others = rest.split('/')[1:]
        rate, address = (*others, *AS_SOLD[len(others) :])
        return f'radio://{int(channel)}/{rate}/{address.upper():0>10}'
    if scheme in ('udp', 'tcp'):
        host, _, port = rest.rpartition(':')
        with suppress(OSError):  # whoever connects says that there is no such host
            host = socket.gethostbyname(host)
        return f'{scheme}://{host}:{int(port)}'
    return uri


@final
class DroneLock:
    """
    The right to command one drone from this machine, whoever else has logged in.

    Parameters
    ----------
    uri : str
        Which.

    Raises
    ------
    BadInput
        If another process has it, or it cannot be known.

    """

    def __init__(self, uri: str) -> None:
        name = hashlib.sha256(normalize_uri(uri).encode()).hexdigest()[:16]
        path = Path(tempfile.gettempdir()) / f'lta-crazyflie-{name}.lock'
        try:
            # Through no link that somebody may have laid here: the file is written to.
            descriptor = os.open(
                path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666
            )
        except OSError as error:
            raise BadInput(
                f'{path}, which says who commands {uri}, cannot be opened ({error.strerror}); '
                'have whoever made it end their bridge, and delete that file.'
            ) from None
        self._file: IO[str] | None = os.fdopen(descriptor, 'r+')
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
