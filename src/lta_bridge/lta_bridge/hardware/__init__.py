# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Real drones on the desk: what hangs on this machine, how it is, and one motor."""
