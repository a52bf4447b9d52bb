"""The break-even map: which light feeds which task, by lamp and cell."""
