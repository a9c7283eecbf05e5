#!/usr/bin/env python3
"""Writes gm11_long.tsv: one-step GM(1,1) forecasts of a long series in 60-digit decimals.

The series is x_k = 2 + k 2^-21 + 2^-36 s_k with s_(k+1) = 1664525 s_k + 1013904223 mod
2^32, s_0 = 1: exact in double precision.  Normal equations (4-23) on the window of the
last p points, with the accumulated series starting at the first of them; no step of the
method under test is shared.
"""
from decimal import Decimal, getcontext

getcontext().prec = 60


def series(n):
    s, out = 1, []
    for k in range(n):
        out.append(2 + k / 2**21 + s / 2**36)
        s = (1664525 * s + 1013904223) % 2**32
    return out


def forecast(x):
    """Next value after x by the textbook: x1(k) - x1(k - 1)."""
    x = [Decimal(v) for v in x]
    total, n = x[0], len(x) - 1
    sz = szz = sy = szy = Decimal(0)
    for v in x[1:]:
        z = total + v / 2
        total += v
        sz += z
        szz += z * z
        sy += v
        szy += z * v
    a = -(n * szy - sz * sy) / (n * szz - sz * sz)
    b = (sy + a * sz) / n
    # x1(k) = (x0 - b/a) exp(-a k) + b/a
    return a, b, (x[0] - b / a) * ((-a * (n + 1)).exp() - (-a * n).exp())


def main():
    x = series(10**6)
    print("# origin: gm11_long.py, 60-digit decimal arithmetic")
    print("rows\torder\ta\tb\tforecast")
    for rows in (100, 1000, 10**4, 10**5, 10**6):
        for order in (4, 5, 6, 7, 10, 15, 20, 30, 40, 50, 60, rows):
            a, b, f = forecast(x[rows - order:rows])
            print("%d\t%d\t%.25e\t%.25e\t%.25e" % (rows, order, a, b, f))


main()
