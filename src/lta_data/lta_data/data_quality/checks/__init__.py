# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Checks of a recording, one file per kind of finding."""
