"""Builders that tests and benches share: definitions, scenes, runs, references.

A test module imports builders, never another test module; each name here has one meaning.
"""
