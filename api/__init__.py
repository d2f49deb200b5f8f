"""The HTTP service: checks problems, queues jobs, serves results. It never solves anything."""
