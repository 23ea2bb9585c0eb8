"""Signals, failing system calls and mutated files: how every command ends, and what it leaves."""
