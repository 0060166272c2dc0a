"""Writes black_body_curve.rs: the colour of black bodies, as polynomials in pieces.

Usage: pip install colour-science numpy; python3 black_body_curve.py > black_body_curve.rs

The CIE 1931 2-degree colour matching functions, 360 to 830 nm by 1 nm, come from the package colour-science
(BSD-3-Clause, version 0.4.7). X, Y and Z are sums over these wavelengths. black_body.rs says what the pieces mean.
"""

import warnings

import numpy as np
from numpy.polynomial import chebyshev

warnings.filterwarnings("ignore")  # The package misses what it does not need here.
import colour  # noqa: E402

LOWEST, SCALE, PIECES, DEGREE = 50.0, 600.0, 16, 7
PLANCK, LIGHT_SPEED, BOLTZMANN = 6.62607015e-34, 299792458.0, 1.380649e-23  # CODATA 2018
LUMINOUS_EFFICACY = 683.0

functions = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
wavelength = np.asarray(functions.wavelengths) * 1e-9
matching = np.asarray(functions.values)
assert len(wavelength) == 471 and (functions.wavelengths[0], functions.wavelengths[-1]) == (360, 830)

second_radiation = PLANCK * LIGHT_SPEED / BOLTZMANN
wien = second_radiation / wavelength[-1]


def logarithms(t):
    """ln X, ln Y, ln Z at the temperatures t."""
    e = second_radiation / (wavelength * t[:, None])
    planck = np.log(2 * PLANCK * LIGHT_SPEED**2 * LUMINOUS_EFFICACY * 1e-9 / wavelength**5) - e - np.log(-np.expm1(-e))
    with np.errstate(divide="ignore"):
        terms = planck[:, :, None] + np.log(matching)
    greatest = terms.max(1)
    return greatest + np.log(np.exp(terms - greatest[:, None]).sum(1))


def smooth(s):
    """ln(Y/T) + wien/T, X/Y and Z/Y at s = T/(T + SCALE)."""
    t = SCALE * s / np.maximum(1 - s, 1e-10)  # Up to 6e12 K, as good as infinite.
    x, y, z = logarithms(t).T
    return np.column_stack([y - np.log(t) + wien / t, np.exp(x - y), np.exp(z - y)])


first = LOWEST / (LOWEST + SCALE)
width = (1 - first) / PIECES
pieces, error = [], 0.0
for i in range(PIECES):
    place = lambda x: first + width * (i + (x + 1) / 2)
    nodes = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    between = np.linspace(-1, 1, 101)
    series = chebyshev.chebfit(nodes, smooth(place(nodes)), DEGREE)
    error = max(error, np.abs(chebyshev.chebval(between, series).T - smooth(place(between))).max())
    pieces.append([[f"{c:z.9f}" for c in chebyshev.cheb2poly(series[:, j])] for j in range(3)])

print(f"""//! Written by `black_body_curve.py`; its greatest error is {error:.1e} of Y.

/// The lowest temperature of the curve, in kelvin.
pub(super) const LOWEST: f64 = {LOWEST};

/// The temperature at the middle of the curve's axis, `s = T/(T + SCALE)`, in kelvin.
pub(super) const SCALE: f64 = {SCALE};

/// The Wien exponent of the longest wavelength, hc/λk for 830 nm, in kelvin.
pub(super) const WIEN: f64 = {wien:.11};

/// Polynomials of ln(Y/T) + WIEN/T, X/Y and Z/Y, constant term first, over pieces of equal width from
/// `LOWEST` to s = 1.
#[rustfmt::skip]
pub(super) const PIECES: [[[f64; {DEGREE + 1}]; 3]; {PIECES}] = [""")
for piece in pieces:
    print("    [")
    for polynomial in piece:
        print(f"        [{', '.join(polynomial)}],")
    print("    ],")
print("];")
