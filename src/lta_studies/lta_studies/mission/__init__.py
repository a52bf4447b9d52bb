# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulate missions over days: charge on a perch, fly when light and reserve allow, return."""
