"""Settings that all tests share."""

from hypothesis import settings

# The same cases on every machine and every run: a failure can be repeated by anyone.
settings.register_profile("repeatable", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("repeatable")
