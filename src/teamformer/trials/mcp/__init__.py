"""Missions for programs that talk: tools and resources of the Model Context Protocol."""
