# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What discovery concludes of some cases of the challenge, number by number."""

import sys

from commands import list_numbers, ROOT

sys.path.append(str(ROOT))

from campaigns.challenge.trial import run_trial

SEED, SECONDS = 17, (30.0, 40.0)
CASES = range(8)
TIMES = {'cpu_s'}  # not compared


def study(number: int) -> dict[str, str]:
    """Return what discovery finds in one case: its verdict, its names and its numbers."""
    result = run_trial(SEED, None, number, SECONDS)
    rest = {key: value for key, value in result.items() if key not in TIMES}
    return {f'case {number} / {path}': value for path, value in list_numbers(rest)}
