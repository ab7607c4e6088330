"""What the notebooks draw, and the checks of what they claim: a module for each page.

`check(names)` of a module asserts the claims of its page, whose variables it is given.
"""
