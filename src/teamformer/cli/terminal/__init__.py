"""What verbs share: the console, progress, Ctrl-C, compiling on a first run."""
