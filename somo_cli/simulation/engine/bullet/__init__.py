"""PyBullet behind the engine interface; no other package imports it."""
