"""The command line: one module a subject, `main` the way in."""
