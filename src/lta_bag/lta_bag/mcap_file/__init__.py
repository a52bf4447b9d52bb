# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parse MCAP files, intact and damaged."""
