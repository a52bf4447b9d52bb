# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare two flights: align their clocks and frames, and find where and when they diverge."""
