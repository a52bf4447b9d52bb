# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wind-tunnel front end: solvers, progress, tables, plots and pages."""
