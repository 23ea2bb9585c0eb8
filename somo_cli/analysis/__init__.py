"""What a scene costs and how far off it is: error against run time, stability, conditioning."""
