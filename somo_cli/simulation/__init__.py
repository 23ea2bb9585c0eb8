"""The file brought to life: scene, plan, spring-damper law, engine, recorder and run."""
