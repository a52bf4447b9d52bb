"""Lock a drone, so that only one process of this machine commands it."""

from contextlib import suppress
import fcntl
import hashlib
import os
from pathlib import Path
import socket
import tempfile
from typing import Final, final, IO

from lta_config.errors import BadInput

AS_SOLD: Final = ('2M', 'E7E7E7E7E7')  # default rate and address of a radio URI


def normalize_uri(uri: str) -> str:
    """Return a canonical URI of a drone, without the number of the radio."""
    scheme, _, rest = uri.partition('://')
    rest = rest.partition('?')[0]
    if scheme == 'radio':
        channel, *others = rest.split('/')[1:]
        rate, address = (*others, *AS_SOLD[len(others) :])
        return f'radio://{int(channel)}/{rate}/{address.upper():0>10}'
    if scheme in ('udp', 'tcp'):
        host, _, port = rest.rpartition(':')
        with suppress(OSError):  # an unknown host is reported when the link connects
            host = socket.gethostbyname(host)
        return f'{scheme}://{host}:{int(port)}'
    return uri


@final
class DroneLock:
    """
    Exclusive lock on one drone, shared by all users of this machine; it ends with the process.

    Raises
    ------
    BadInput
        If another process holds the lock, or the lock file cannot be opened.

    """

    _file: IO[str] | None

    def __init__(self, uri: str) -> None:
        name = hashlib.sha256(normalize_uri(uri).encode()).hexdigest()[:16]
        path = Path(tempfile.gettempdir()) / f'lta-crazyflie-{name}.lock'
        self._path, self._file = path, _open_lock(path, uri)
        self._file.truncate(0)
        self._file.write(str(os.getpid()))
        self._file.flush()

    def close(self) -> None:
        """Release the drone; a second call does nothing."""
        if self._file is not None:
            with suppress(OSError):  # another user's file stays
                self._path.unlink()
            self._file.close()
            self._file = None


def _open_lock(path: Path, uri: str) -> IO[str]:
    """Open and lock the file of a drone, not one that its last holder has deleted meanwhile."""
    while True:
        try:
            # O_NOFOLLOW: another user could have placed a symbolic link here.
            descriptor = os.open(
                path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666
            )
        except OSError as error:
            raise BadInput(
                f'The lock file {path} of {uri} cannot be opened ({error.strerror}). Ask the user '
                'who owns the file to stop the bridge and to delete the file.'
            ) from None
        file = os.fdopen(descriptor, 'r+')
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            holder = file.read().strip() or 'unknown'
            file.close()
            raise BadInput(
                f'Another program (process {holder}) already commands the Crazyflie {uri}; stop '
                'it first, because a drone obeys every sender.'
            ) from None
        with suppress(FileNotFoundError):
            if path.stat().st_ino == os.fstat(file.fileno()).st_ino:
                return file
        file.close()
