"""Lock a ROS domain for one launch of simulated flights: two would mix their /clock."""

from collections.abc import Sequence
import fcntl
import os
from pathlib import Path
import tempfile
from typing import final, Self

from lta_config.errors import BadInput

HIGHEST_DOMAIN = 232  # the ports of a higher one would exceed 16 bits
LONGEST_NAMES = 4096  # bytes read of the robots' names


@final
class DomainLock:
    """
    Hold the current ROS domain during a flight; the kernel releases it even after SIGKILL.

    Parameters
    ----------
    robots : str
        Namespaces of the robots; they share one /clock.

    Raises
    ------
    BadInput
        On entering, if another flight of this user holds the domain, or it does not exist.

    """

    def __init__(self, *robots: str) -> None:
        self._domain = os.environ.get('ROS_DOMAIN_ID', '0') or '0'
        folder = Path(os.environ.get('XDG_RUNTIME_DIR') or tempfile.gettempdir())
        self._path = folder / f'lta-{os.getuid()}-{self._domain}.lock'
        self._robots = robots

    def __enter__(self) -> Self:
        """Acquire the lock."""
        if not (self._domain.isdecimal() and int(self._domain) <= HIGHEST_DOMAIN):
            raise BadInput(
                f"ROS_DOMAIN_ID is '{self._domain}', but must be a number from 0 to "
                f'{HIGHEST_DOMAIN}; correct or unset it.'
            )
        try:
            # No symbolic links: in a shared /tmp one could make us overwrite another file
            flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
            self._file = os.open(self._path, flags, 0o600)
        except OSError as error:
            raise BadInput(
                f"The lock file '{self._path}' cannot be opened ({error.strerror}); remove the "
                'file.'
            ) from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            holder = os.pread(self._file, LONGEST_NAMES, 0).decode(errors='replace')
            os.close(self._file)
            raise BadInput(
                f'{holder or "A robot is"} flying on ROS domain {self._domain} already, and all '
                'robots on a domain share /clock; wait until this flight ends, or choose another '
                f'domain: export ROS_DOMAIN_ID={(int(self._domain) + 1) % (HIGHEST_DOMAIN + 1)}.'
            ) from None
        # A shorter name must not leave the end of an older one
        os.ftruncate(self._file, 0)
        os.pwrite(self._file, format_holders(self._robots).encode(), 0)
        return self

    def __exit__(self, *_: object) -> None:
        """Release the lock."""
        # Do not remove the file: a process that has opened it would then lock an invisible file
        os.close(self._file)


def format_holders(robots: Sequence[str]) -> str:
    """Return the start of a sentence: 'lta1 is', 'lta1 and lta2 are'."""
    *others, last = robots
    return f'{", ".join(others)} and {last} are' if others else f'{last} is'
