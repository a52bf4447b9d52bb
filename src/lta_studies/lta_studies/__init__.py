# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Studies: light, energy, missions, wind, tuning, platforms, wind tunnel and the seed paper."""
