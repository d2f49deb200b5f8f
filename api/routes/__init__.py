"""One file of routes for each concern."""
