"""
The last resort against processes that outlive a killed launcher.

When a launcher dies, the kernel sends SIGINT to its processes; one that ignores it, or hangs,
would stay. The guard is a tiny shell that knows the process groups, notices by a closed pipe that
the launcher is gone, gives the processes their grace, and kills what is left.
"""

from contextlib import suppress
import subprocess
from typing import final

SCRIPT = """
trap '' INT TERM HUP
groups=
while read -r group; do groups="$groups $group"; done
turns=$1
while [ "$turns" -gt 0 ]; do
  alive=
  for group in $groups; do kill -0 "-$group" && alive=yes; done
  [ "$alive" ] || exit 0
  sleep 0.1
  turns=$((turns - 1))
done
for group in $groups; do kill -9 "-$group"; done
"""


@final
class ProcessGuard:
    """
    A guard over the processes of one launcher.

    Parameters
    ----------
    grace : float
        Time between the launcher's death and that of its processes. [s]

    """

    def __init__(self, grace: float) -> None:
        self._popen = subprocess.Popen(
            ['/bin/sh', '-c', SCRIPT, 'sh', str(round(10 * grace))],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def add_group(self, group: int) -> None:
        """Put a process group under guard."""
        assert self._popen.stdin is not None
        with suppress(BrokenPipeError):
            self._popen.stdin.write(f'{group}\n'.encode())
            self._popen.stdin.flush()

    def dismiss(self) -> None:
        """End the guard: every process is gone."""
        self._popen.kill()
        with suppress(BrokenPipeError):
            self._popen.communicate()
