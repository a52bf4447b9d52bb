# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wire, synchronise, monitor and launch the LTA nodes."""
