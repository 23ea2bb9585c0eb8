"""PyBullet behind the interface of an engine; nothing else knows it."""
