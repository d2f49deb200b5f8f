"""The ports over one Redis or Valkey server, 6.2 or later, with RQ as the queue."""
