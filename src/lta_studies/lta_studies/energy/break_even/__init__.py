"""Break-even map: the light that powers each task, by lamp and cell."""
