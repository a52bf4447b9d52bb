# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Live view of a running graph in Foxglove."""
