"""The server of pages: who may connect, what is asked of it, what can be taken along."""
