# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta doctor: check this machine."""

from contextlib import nullcontext
from dataclasses import asdict

from lta_analysis.console import plain_console
from lta_cli.doctor import exit_status, iterate_check_results, print_checks
from lta_cli.request_command import Json, print_json
import typer


def doctor(
    json: Json = False,
) -> None:
    """
    Check Python, wheels, DDS discovery, ports and disk, and suggest fixes.

    Exit status 1 if a check fails; warnings give 0.
    """
    console = plain_console()
    waiting = console.status('checking this machine ...')
    with waiting if console.is_terminal else nullcontext():
        # The DDS check takes a few seconds
        results = list(iterate_check_results())
    if json:
        print_json([asdict(item) for item in results])
    else:
        print_checks(results, console)
    raise typer.Exit(exit_status(results))
