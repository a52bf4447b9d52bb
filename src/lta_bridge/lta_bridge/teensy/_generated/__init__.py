# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Modules that the build writes; linters pass over a folder that begins with `_`."""
