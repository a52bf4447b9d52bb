# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Functions for the tests of workers, which worker processes must be able to import."""

import os
from pathlib import Path
import signal
import time

from lta_config.errors import BadInput
from lta_report.workers import report_progress
from waiting import PATIENCE


def die_at(folder, item):
    """Square a number, but die at 2, and at 1 the first time only."""
    mark = Path(folder) / 'died'
    if item == 2 or (item == 1 and not mark.exists()):
        if item == 1:
            mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return item**2


def fail_at_odd(item):
    """Square even numbers only; 3 is bad input, others are a defect."""
    if item == 3:
        raise BadInput('3 is not even.')
    if item % 2:
        raise ArithmeticError('odd')
    return item**2


def end_at_once(_):
    """End the process as a machine without memory would."""
    os._exit(7)


def square_late(item):
    """Square a number; the smallest takes longest."""
    time.sleep(0.2 / (1 + item))
    return item**2


def square_in_halves(item):
    """Report that half is done, then square a number."""
    report_progress(0.5)
    return item**2


def describe_process(_):
    """Return the environment and the blocked signals of the process."""
    blocked = signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())
    return os.getpid(), blocked, os.environ.get('OMP_NUM_THREADS')


def start_and_wait(folder, item):
    """Leave a note and compute for minutes, except at 0."""
    (Path(folder) / f'{os.getpid()}.pid').touch()
    if item:
        time.sleep(PATIENCE)
    return item


def return_lambda(_):
    """Return what cannot be sent to another process."""
    return lambda: None
