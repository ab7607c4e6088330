"""Run the command line: ``python -m bridgectl``."""

from bridgectl.cli import main

raise SystemExit(main())
