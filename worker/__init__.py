"""Takes a job id, runs the engine under limits, reports progress, stores the result."""
