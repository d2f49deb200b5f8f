"""The shared language: problems, results, jobs, events and errors, as pydantic models.

Imports nothing but pydantic, orjson and the standard library, so every room may import it.
"""
