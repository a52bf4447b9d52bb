# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The version of LTA; a test compares setup.py, package.xml and CITATION.cff with it."""

from typing import Final

VERSION: Final = '1.0.0'
