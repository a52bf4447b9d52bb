"""
Kill processes that outlive a killed launcher.

When a launcher dies, the kernel sends SIGINT to its processes, but one that ignores it or hangs
would remain. The guard is a small shell that knows the process groups. A closed pipe shows that
the launcher is gone; then the guard waits for the grace time and kills what is left.
"""

from contextlib import suppress
import subprocess
from typing import final

# `read` fails once the launcher's end of the pipe is closed. `turns` are tenths of a second
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

    `grace`: time between the death of the launcher and SIGKILL to its processes [s].
    """

    def __init__(self, grace: float) -> None:
        self._popen = subprocess.Popen(
            # A shell starts faster and needs less memory than Python
            ['/bin/sh', '-c', SCRIPT, 'sh', str(round(10 * grace))],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            # A signal to the launcher's group must not reach the guard
            start_new_session=True,
        )

    def add_group(self, group: int) -> None:
        """Add a process group to the guarded ones."""
        assert self._popen.stdin is not None
        # The guard may have been killed; the launcher works without it
        with suppress(BrokenPipeError):
            self._popen.stdin.write(f'{group}\n'.encode())
            self._popen.stdin.flush()

    def dismiss(self) -> None:
        """End the guard once every process has ended."""
        # SIGKILL, because the script ignores the other signals
        self._popen.kill()
        with suppress(BrokenPipeError):
            self._popen.communicate()
