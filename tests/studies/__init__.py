"""The studies that SoMo is known for, each a scene of definitions/ and the figures it gives.

`make studies` runs them at full length; the tests beside them a short version of each.
"""

import os

# as the command has it, and before numpy is loaded
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
