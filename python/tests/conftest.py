"""The examples of a run are those of every other run; UMBRAGE_PYTHON_EXAMPLES is how many a property has."""

import os

from hypothesis import settings

examples = int(os.environ.get("UMBRAGE_PYTHON_EXAMPLES", "100"))
settings.register_profile("same", derandomize=True, database=None, deadline=None, max_examples=examples)
settings.load_profile("same")
