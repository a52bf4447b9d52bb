# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Flights: in one process, as a graph of nodes, in sweeps, and replays of recordings."""
