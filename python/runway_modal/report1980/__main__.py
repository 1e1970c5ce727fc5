"""``python -m runway_modal.report1980``."""

from .command import main

main()
