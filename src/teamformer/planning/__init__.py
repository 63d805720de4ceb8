"""Plans made before anybody moves: distances, tours, schedules and bounds."""
