"""`python -m moseg`: the command line."""

from moseg.workflows.cli import main

if __name__ == "__main__":
    main()
