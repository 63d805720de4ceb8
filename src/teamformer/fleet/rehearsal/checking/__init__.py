"""The checker of rehearsals: what was promised and not kept, by the trace alone."""
