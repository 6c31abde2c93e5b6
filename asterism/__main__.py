"""`python -m asterism`."""

from asterism.cli.main import main

main()
