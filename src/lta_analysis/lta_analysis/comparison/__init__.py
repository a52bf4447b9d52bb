# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare two flights: request, sentences, figures and report."""
