"""One flight of one robot on one ROS domain at a time: two would hear each other's commands."""

import fcntl
import os
from pathlib import Path
import tempfile
from types import TracebackType
from typing import final, Self

from lta_config.errors import BadInput

HIGHEST_DOMAIN = 232  # whose ports still fit into 16 bits


@final
class Session:
    """
    Hold a robot's name on the present ROS domain; the kernel lets go even after SIGKILL.

    Parameters
    ----------
    robot : str
        Namespace of the robot.

    Raises
    ------
    BadInput
        On entering, if another flight of this user holds it, or there is no such domain.

    """

    def __init__(self, robot: str) -> None:
        self._domain = os.environ.get('ROS_DOMAIN_ID', '0') or '0'
        folder = Path(os.environ.get('XDG_RUNTIME_DIR') or tempfile.gettempdir())
        self._path = folder / f'lta-{os.getuid()}-{self._domain}-{robot}.lock'
        self._robot = robot

    def __enter__(self) -> Self:
        """Take the name."""
        if not (self._domain.isdecimal() and int(self._domain) <= HIGHEST_DOMAIN):
            raise BadInput(
                f"ROS_DOMAIN_ID is '{self._domain}', but must be a number from 0 to "
                f'{HIGHEST_DOMAIN}; set it anew or unset it.'
            )
        try:
            self._file = os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError as error:
            raise BadInput(
                f"'{self._path}' cannot be opened ({error.strerror}); remove it."
            ) from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._file)
            raise BadInput(
                f'{self._robot} is flying on ROS domain {self._domain} already; wait for it, or '
                'choose another domain: ROS_DOMAIN_ID=1 lta fly.'
            ) from None
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Give the name back."""
        # The file stays: whoever opened it before a removal would lock what nobody else sees.
        os.close(self._file)
