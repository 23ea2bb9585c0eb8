"""From what a lab measures to what the simulator needs: stiffness, torque, damping, fit of all."""
