"""Wind-tunnel front end: solvers, progress, tables, plots and pages."""
