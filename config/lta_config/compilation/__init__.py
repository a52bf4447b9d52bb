# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compile plain Python functions with numba, and cache them by their source."""
