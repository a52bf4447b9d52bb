# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Sweeps of many flights: plan, fly in parallel, log, tabulate and plot."""
