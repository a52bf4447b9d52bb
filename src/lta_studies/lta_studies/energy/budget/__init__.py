# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Power budget by task, from simulated flights, compared with the seed paper."""
