"""From the NLP's point to the published solution."""
