"""Where robots charge before they go on, and when plans are done in which they do."""
