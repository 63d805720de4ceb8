"""A vehicle that speaks VDA5050 over MQTT, as the body of a robot."""
