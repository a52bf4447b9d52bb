# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Run a headless Chromium to inspect and photograph pages.

The module uses the Chrome DevTools Protocol over two pipes (--remote-debugging-pipe): JSON
messages that end with a zero byte. No port is opened, and the browser ends with this process.
"""

from collections.abc import Mapping
from contextlib import suppress
import fcntl
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from typing import Any, Final, final, Self

from lta_config.errors import BadInput

BROWSER_NAMES: Final = (
    'chromium',
    'chromium-browser',
    'google-chrome',
    'google-chrome-stable',
    'chrome',
)
OVERRIDE: Final = 'LTA_CHROMIUM'  # environment variable
NO_BROWSER: Final = (
    'No Chromium was found; install it (Debian or Ubuntu: sudo apt install chromium) or set '
    f'{OVERRIDE} to the program.'
)
FLAGS: Final = (
    '--headless=new',
    '--remote-debugging-pipe',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-default-apps',
    # Containers have a /dev/shm of 64 MB, which is too small for large pages
    '--disable-dev-shm-usage',
    '--disable-domain-reliability',
    '--disable-extensions',
    # Drawing by the CPU is faster without the detour over a graphics card
    '--disable-gpu',
    '--disable-sync',
    # WebGL without a graphics card, for the 3-D views
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
    # A scroll bar would be in the picture
    '--hide-scrollbars',
    '--metrics-recording-only',
    '--mute-audio',
    '--no-default-browser-check',
    '--no-first-run',
    '--no-pings',
    # Do not ask the desktop's key ring
    '--password-store=basic',
)
READ, WRITE = 3, 4  # file descriptors on which Chromium expects its ends of the pipes
ANSWER_PATIENCE = 300.0  # s; a cold start or one page on a busy machine took more than 30
DRAWING_PATIENCE = 30.0  # s to wait after a script error: the page may still finish, but soon


def find_chromium() -> str:
    """
    Return the path of the browser.

    Raise `BadInput` if there is none; the message explains how to install one.
    """
    named = os.environ.get(OVERRIDE)
    if named:
        path = shutil.which(named)
        if path is None:
            raise BadInput(
                f"{OVERRIDE} is '{named}', which is not an executable program; correct or unset "
                'this environment variable.'
            )
        return path
    for name in BROWSER_NAMES:
        path = shutil.which(name)
        if path is not None:
            return path
    raise BadInput(NO_BROWSER)


@final
class Browser:
    """
    A headless browser with one tab; use it as a context manager.

    Attribute `events`: all events of the tab so far: method and parameters.
    """

    def __init__(self) -> None:
        self._program = find_chromium()
        self.events: list[tuple[str, dict[str, Any]]] = []
        self._buffer = b''
        self._count = 0
        self._session: str | None = None
        # An own profile, since a running browser locks the user's
        self._profile = tempfile.TemporaryDirectory(
            prefix='lta-browser-', ignore_cleanup_errors=True
        )
        self._process, self._out, self._in = launch_browser(self._program, self._profile.name)

    def __enter__(self) -> Self:
        """Open the tab."""
        try:
            target = self.call('Target.createTarget', url='about:blank')['targetId']
            attached = self.call('Target.attachToTarget', targetId=target, flatten=True)
            self._session = attached['sessionId']
            # A domain sends events only once it is enabled
            for domain in ('Page', 'Runtime', 'Log', 'Network'):
                self.call(f'{domain}.enable')
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """End the browser."""
        self.close()

    def close(self) -> None:
        """Stop the browser in any state."""
        with suppress(OSError, BadInput, subprocess.TimeoutExpired):
            # Browser.close is a command to the browser, not to the tab
            self._session = None
            self.call('Browser.close')
            self._process.wait(5.0)
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        os.close(self._in)
        os.close(self._out)
        self._profile.cleanup()

    def call(self, method: str, **parameters: object) -> Mapping[str, Any]:
        """
        Send a command of the protocol and return its result.

        Raise `BadInput` if the browser rejects it, does not answer, or has exited.
        """
        self._count += 1
        command: dict[str, object] = {'id': self._count, 'method': method, 'params': parameters}
        if self._session is not None:
            command['sessionId'] = self._session
        try:
            os.write(self._out, json.dumps(command).encode() + b'\0')
        except BrokenPipeError as error:
            raise self._build_exit_error(method) from error
        while True:
            message = self._read_message(method)
            # Messages without this id are events, stored by `_read_message`
            if message.get('id') == self._count:
                if 'error' in message:
                    raise BadInput(f'Chromium rejected {method}: {message["error"]["message"]}.')
                answer: Mapping[str, Any] = message['result']
                return answer

    def evaluate(self, expression: str) -> Any:
        """Return the value of an expression in the page; a promise is awaited."""
        answer = self.call(
            'Runtime.evaluate', expression=expression, awaitPromise=True, returnByValue=True
        )
        return answer['result'].get('value')

    def wait_until(self, expression: str) -> None:
        """Wait until an expression is true in the page; raise `BadInput` if it never is."""
        begun, before = time.monotonic(), len(self.events)
        while not self.evaluate(f'Boolean({expression})'):
            took = time.monotonic() - begun
            failed = any(name == 'Runtime.exceptionThrown' for name, _ in self.events[before:])
            if took > (DRAWING_PATIENCE if failed else ANSWER_PATIENCE):
                why = (
                    'because a script in it failed'
                    if failed
                    else 'perhaps because the machine is busy'
                )
                raise BadInput(
                    f'Chromium did not draw the HTML page within {took:.0f} s, {why}; try '
                    'again, or open the page in a browser and look for errors.'
                )
            time.sleep(0.02)

    def _read_message(self, method: str) -> dict[str, Any]:
        """Return the next message; events are also stored."""
        end = time.monotonic() + ANSWER_PATIENCE
        while b'\0' not in self._buffer:
            ready, _, _ = select.select([self._in], [], [], max(0.0, end - time.monotonic()))
            if not ready:
                raise BadInput(
                    f'Chromium did not answer {method} within {ANSWER_PATIENCE:g} s; try '
                    f'again when the '
                    'machine is less busy.'
                )
            data = os.read(self._in, 1 << 20)  # at most 1 MiB at once
            if not data:
                raise self._build_exit_error(method)
            self._buffer += data
        text, _, self._buffer = self._buffer.partition(b'\0')
        message: dict[str, Any] = json.loads(text)
        if 'method' in message:
            self.events.append((message['method'], message.get('params', {})))
        return message

    def _build_exit_error(self, method: str) -> BadInput:
        """Return the error for a browser that has exited."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(1.0)
        return BadInput(
            f'Chromium ({self._program}) exited with status {self._process.returncode} during '
            f'the command {method}; start Chromium in a terminal to see why.'
        )


def launch_browser(program: str, profile: str) -> tuple[subprocess.Popen[bytes], int, int]:
    """Return a running browser, the file descriptor to write to and the one to read from."""
    theirs_in, ours_out = os.pipe()
    ours_in, theirs_out = os.pipe()
    # Copies above READ and WRITE, so that dup2 to one cannot overwrite the other
    copies = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in (theirs_in, theirs_out)]

    def place_pipes() -> None:
        os.dup2(copies[0], READ)
        os.dup2(copies[1], WRITE)

    flags = [*FLAGS, f'--user-data-dir={profile}']
    if os.geteuid() == 0:
        flags.append('--no-sandbox')  # the sandbox does not start as root
    process = subprocess.Popen(
        [program, *flags],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        # The pipe ends at 3 and 4 must survive; all other descriptors are close-on-exec by default
        close_fds=False,
        preexec_fn=place_pipes,
    )
    # The browser's ends must be closed here, or its exit would not end our read
    for end in (theirs_in, theirs_out, *copies):
        os.close(end)
    return process, ours_out, ours_in
