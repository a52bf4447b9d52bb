# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Prepare measured flights: read, check, resample to one grid, cut into pieces."""
