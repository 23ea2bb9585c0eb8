"""A scene simulated: the plan, the engine, the law, monitors and recording, and the run of them."""
