"""Settings that all tests share."""

import signal

from hypothesis import settings

# The same cases on every machine and every run: a failure can be repeated by anyone.
settings.register_profile("repeatable", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("repeatable")

# A shell starts what runs in the background deaf to Ctrl-C, and so deaf the tests of Ctrl-C would
# compute on for ever.
signal.signal(signal.SIGINT, signal.default_int_handler)
