"""`python -m teamformer.cli`."""

from teamformer.cli import main

main()
