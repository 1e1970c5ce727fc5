"""Settings that all tests share."""

import signal

from hypothesis import settings

# The same cases on every machine and every run: a failure can be repeated by anyone.
settings.register_profile("repeatable", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("repeatable")

# Shells start background jobs with SIGINT ignored; the Ctrl-C tests would then never end.
signal.signal(signal.SIGINT, signal.default_int_handler)
