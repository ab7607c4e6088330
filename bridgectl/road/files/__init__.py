"""Readers and writers of road files."""
