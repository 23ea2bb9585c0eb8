"""The studies that SoMo is known for, each a scene of definitions/ and the figures it gives.

`make studies` runs them at full length; tests/test_studies.py a short version of each.
"""
