# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Playing a recording back into a graph: what, when, and whose answers are waited for."""
