"""Records as files of JSON: written, and read with everything checked."""
