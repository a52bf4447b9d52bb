# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Programs that score, measure or fly for minutes or hours: `make campaign NAME`.

Each module that has a `CAMPAIGN` is one; `harness.py` runs them all alike.
"""

from pathlib import Path
import sys

ROOT = Path(__file__).resolve().parents[1]
# The tests' own tools: peers, domains, commands
sys.path += [str(ROOT), str(ROOT / 'test'), str(ROOT / 'test/integration')]
