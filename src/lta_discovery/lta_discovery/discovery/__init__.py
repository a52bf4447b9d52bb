# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find what a vehicle file lacks: the search of `posterior`, forecasts, conclusion, report."""
