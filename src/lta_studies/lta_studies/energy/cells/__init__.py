# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare solar cells by the seed paper's criterion and a fair one, and build arrays."""
