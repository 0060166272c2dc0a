"""Writes flux.csv: the flux of a Page-Thorne disk around a Schwarzschild hole, computed with 80 digits by mpmath.

Usage: python3 flux.py > flux.csv

The first column is the inverse radius u as a 64-bit number, taken as exact. `relative` is F over the greatest F,
from the closed form of the integral B; `signed_root` is its square root with the sign of 1 - 3u.
"""

from mpmath import diff, findroot, log, mp, mpf, nstr, sqrt

mp.dps = 80


def flux(big_r):
    """B(R) / (R^(5/2) (R - 3)), R in units of GM/c^2."""
    x = sqrt(big_r)
    a, b = sqrt(3), sqrt(6)
    bracket = x - b + a / 2 * log((x + a) * (b - a) / ((x - a) * (b + a)))
    return bracket / (big_r ** mpf(2.5) * (big_r - 3))


peak = findroot(lambda r: diff(lambda t: log(flux(t)), r), (mpf("9.5"), mpf("9.6")), tol=mpf(10) ** -60)
greatest = flux(peak)

radii = [6 * (1 + 10.0 ** -k) for k in range(9, 0, -1)] + [6.3, 7, 8, 9, 9.5, 10, 11, 12, 14, 17, 20, 25, 30, 40, 60]
radii += [m * 10.0**k for k in range(2, 10) for m in (1, 3)][:-1]
# Inside the innermost stable orbit, where only the continuation of the root is of use.
radii += [6 * (1 - 10.0 ** -k) for k in range(9, 0, -1)] + [5, 4.5, 4, 3.7, 3.5, 3.4]

print(f"# u = 2/R; greatest at R = {nstr(peak, 30)}, where B/(R^(5/2) (R-3)) = {nstr(greatest, 30)}")
print("u,relative,signed_root")
for u in sorted({2 / r for r in radii}):
    relative = flux(2 / mpf(u)) / greatest
    root = sqrt(relative) * (1 if 3 * mpf(u) < 1 else -1)
    print(f"{u!r},{nstr(relative, 25)},{nstr(root, 25)}")
