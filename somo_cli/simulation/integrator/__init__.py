"""The spring-damper law and what steps one body or object."""
