"""One study a row: it measures what the row's file declares, by the cores of the other verbs."""
