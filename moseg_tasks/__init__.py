"""The science: pure functions from arrays to arrays, one method a file.

Points are xy, arrays are indexed [y, x], pixel centres lie at integers. Flow is (u, v) in px/frame.
"""
