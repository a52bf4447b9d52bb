# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly thousands of closed loops at once, with one source for CPU cores and GPU."""
