"""Rough contact, stress, wear particles, filters, separation and remaining wear life for
numpy.

A thin layer over the shared library libwearpipe.so.0 by ctypes: arrays in, arrays out, SI
units, the same numbers as the programs.  The library is looked for in the folder that
WEARPIPE_LIBRARY names, beside an installed prefix, and where the system looks.

    import wearpipe
    heights = wearpipe.surface(128, 1e-3, sq=0.8e-6, corr=1e-4)
    pressure, result = wearpipe.press(heights, 1e-3 / 128, 50e6, estar=115e9)
"""
import ctypes
import ctypes.util
import os
import warnings
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_long, c_size_t, c_uint32, c_uint64, c_void_p
from types import SimpleNamespace

import numpy as np


class Error(RuntimeError):
    """What the library reports: out of memory, a parameter out of range, no solution."""


def _open():
    folder = os.environ.get("WEARPIPE_LIBRARY")
    here = os.path.dirname(os.path.abspath(__file__))
    places = [os.path.join(p, "libwearpipe.so.0") for p in
              ([folder] if folder else []) +
              [os.path.join(here, up, "lib") for up in ("../..", "../../..", "../../../..")]]
    for place in places:
        if os.path.exists(place):
            return ctypes.CDLL(place)
    return ctypes.CDLL(ctypes.util.find_library("wearpipe") or "libwearpipe.so.0")


_lib = _open()
_OK, _NOT_CONVERGED, _CUT_OFF = 0, 4, 6
_array = np.ctypeslib.ndpointer(dtype=np.float64, flags="C_CONTIGUOUS")


def _struct(*fields):
    return type("Struct", (ctypes.Structure,), {"_fields_": list(fields)})


def _function(name, result, *arguments):
    f = getattr(_lib, name)
    f.restype, f.argtypes = result, list(arguments)
    return f


_text = _function("wp_status_text", c_char_p, c_int)
version = _function("wp_version", c_char_p)().decode()


def _check(status, allowed=(_OK,)):
    if status not in allowed:
        raise Error(_text(status).decode())


def _made(pointer, status):
    if not pointer:
        raise Error(_text(status.value).decode())
    return pointer


def _numbers(values):
    """As doubles; what an array masks is missing, nan."""
    if np.ma.isMaskedArray(values):
        values = values.astype(np.float64).filled(np.nan)
    return np.array(values, dtype=np.float64, order="C")


def _field(values):
    field = _numbers(values)
    if field.ndim != 2:
        raise ValueError("want a field [iy, ix], got %d dimensions" % field.ndim)
    return field


# --- surfaces

_SurfacePar = _struct(("nx", c_int), ("ny", c_int), ("lx", c_double), ("ly", c_double),
                      ("kind", c_int), ("sq", c_double), ("corr_x", c_double),
                      ("corr_y", c_double), ("hurst", c_double), ("rolloff", c_double),
                      ("cutoff", c_double), ("seed", c_uint64))
_ROUGHNESS = ("sa", "sq", "ssk", "sku", "sp", "sv", "sz", "sdq", "sdr", "sal", "str")
_Roughness = _struct(*[(name, c_double) for name in _ROUGHNESS])
_surface_new = _function("wp_surface_new", c_void_p, POINTER(_SurfacePar), POINTER(c_int))
_surface_free = _function("wp_surface_free", None, c_void_p)
_surface_heights = _function("wp_surface_heights", c_int, c_void_p, c_uint32, _array)
_roughness = _function("wp_roughness", c_int, c_int, c_int, c_double, c_double, _array,
                       POINTER(_Roughness))


def surface(points, length, sq=1e-6, corr=None, kind="gauss", hurst=0.8, rolloff=0.0,
            cutoff=0.0, seed=1, realisation=0):
    """A rough surface: heights [iy, ix], m.  points and length (m): one number or (x, y);
    corr: correlation lengths; kind: gauss, exponential or self-affine (by hurst)."""
    nx, ny = (points, points) if np.isscalar(points) else points
    lx, ly = (length, length * ny / max(nx, 1)) if np.isscalar(length) else length
    corr = 0.1 * lx if corr is None else corr
    cx, cy = (corr, corr) if np.isscalar(corr) else corr
    par = _SurfacePar(nx, ny, lx, ly, ("gauss", "exponential", "self-affine").index(kind), sq,
                      cx, cy, hurst, rolloff, cutoff, seed)
    status = c_int()
    s = _made(_surface_new(byref(par), byref(status)), status)
    try:
        heights = np.empty((ny, nx))
        _check(_surface_heights(s, realisation, heights))
        return heights
    finally:
        _surface_free(s)


def roughness(heights, spacing):
    """Parameters of ISO 25178-2 as attributes: sa, sq, ssk, sku, sp, sv, sz, sdq, sdr, sal, str."""
    heights = _field(heights)
    dx, dy = (spacing, spacing) if np.isscalar(spacing) else spacing
    r = _Roughness()
    _check(_roughness(heights.shape[1], heights.shape[0], dx, dy, heights, byref(r)))
    return SimpleNamespace(**{name: getattr(r, name) for name in _ROUGHNESS})


# --- contact

_ContactPar = _struct(("nx", c_int), ("ny", c_int), ("dx", c_double), ("dy", c_double),
                      ("estar", c_double), ("hardness", c_double), ("periodic", c_int),
                      ("tolerance", c_double), ("threads", c_int))
_CONTACT = ("pressure", "load", "approach", "indentation", "area", "energy", "gap")
_ContactResult = _struct(*[(name, c_double) for name in _CONTACT], ("iterations", c_long),
                         ("edge_load", c_double))
_contact_new = _function("wp_contact_new", c_void_p, POINTER(_ContactPar), POINTER(c_int))
_contact_free = _function("wp_contact_free", None, c_void_p)
_contact_press = _function("wp_contact_press", c_int, c_void_p, _array, c_double, _array,
                           c_void_p, POINTER(_ContactResult))
modulus = _function("wp_contact_modulus", c_double, c_double, c_double, c_double, c_double)


def press(heights, spacing, pressure, estar, hardness=0.0, periodic=False, tolerance=1e-8,
          threads=1):
    """Presses a rough surface with a mean pressure (Pa).  Returns the pressure [iy, ix] and
    the result: load, approach, area, energy, gap, converged, edge_load, ...  Warns where the
    outermost cells of a free grid carry most of the load."""
    heights = _field(heights)
    dx, dy = (spacing, spacing) if np.isscalar(spacing) else spacing
    ny, nx = heights.shape
    par = _ContactPar(nx, ny, dx, dy, estar, hardness, periodic, tolerance, threads)
    status = c_int()
    c = _made(_contact_new(byref(par), byref(status)), status)
    try:
        p, r = np.zeros((ny, nx)), _ContactResult()
        status = _contact_press(c, heights, pressure, p, None, byref(r))
        _check(status, (_OK, _NOT_CONVERGED, _CUT_OFF))
        if status == _CUT_OFF:
            warnings.warn("the outermost cells carry %.0f %% of the load: the edge of the grid "
                          "cuts off the contact: use a larger grid, or periodic=True" %
                          (100 * r.edge_load), stacklevel=2)
        found = {name: getattr(r, name) for name in _CONTACT + ("iterations", "edge_load")}
        return p, SimpleNamespace(converged=status != _NOT_CONVERGED, **found)
    finally:
        _contact_free(c)


# --- wear particles

_DebrisPar = _struct(("nx", c_int), ("ny", c_int), ("dx", c_double), ("dy", c_double),
                     ("cell", c_double), ("periodic", c_int), ("poisson", c_double),
                     ("friction", c_double), ("yield_", c_double), ("potential", c_int),
                     ("threads", c_int))
_PARTICLE = ("cells", "volume", "diameter", "length", "width", "solidity", "x", "y", "z")
_debris_new = _function("wp_debris_new", c_void_p, POINTER(_DebrisPar), POINTER(c_int))
_debris_free = _function("wp_debris_free", None, c_void_p)
_debris_wear = _function("wp_debris_wear", c_int, c_void_p, _array, _array,
                         POINTER(POINTER(c_double)), POINTER(c_size_t))
_debris_beyond = _function("wp_debris_beyond", c_double, c_void_p)


def wear(heights, pressure, spacing, yield_stress, friction=0.0, poisson=0.3, cell=0.0,
         periodic=False, potential=False, threads=1):
    """One step of wear.  Returns the worn heights and the particles as a structured array
    with the fields cells, volume, diameter, length, width, solidity, x, y, z (SI).  Warns
    where the border of a free grid cuts off a considerable part of them."""
    worn, pressure = _field(heights), _field(pressure)
    if worn.shape != pressure.shape:
        raise ValueError("heights and pressure differ in shape")
    dx, dy = (spacing, spacing) if np.isscalar(spacing) else spacing
    ny, nx = worn.shape
    par = _DebrisPar(nx, ny, dx, dy, cell, periodic, poisson, friction, yield_stress,
                     potential, threads)
    status = c_int()
    d = _made(_debris_new(byref(par), byref(status)), status)
    try:
        rows, count = POINTER(c_double)(), c_size_t()
        status = _debris_wear(d, worn, pressure, byref(rows), byref(count))
        _check(status, (_OK, _CUT_OFF))
        kind = np.dtype([(name, np.float64) for name in _PARTICLE])
        if not count.value:
            return worn, np.empty(0, kind)
        flat = np.ctypeslib.as_array(rows, (count.value * len(_PARTICLE),))
        particles = flat.copy().view(kind)
        if status == _CUT_OFF:
            warnings.warn("particles are cut off at the border of the grid, where up to %.0f %% more "
                          "volume is lost: use a larger grid, or periodic=True" %
                          (100 * _debris_beyond(d) / particles["volume"].sum()), stacklevel=2)
        return worn, particles
    finally:
        _debris_free(d)


# --- stress

_StressPar = _struct(("nx", c_int), ("ny", c_int), ("dx", c_double), ("dy", c_double),
                     ("periodic", c_int), ("poisson", c_double), ("friction", c_double),
                     ("threads", c_int))
_stress_new = _function("wp_stress_new", c_void_p, POINTER(_StressPar), POINTER(c_int))
_stress_free = _function("wp_stress_free", None, c_void_p)
_stress_load = _function("wp_stress_load", c_int, c_void_p, _array)
_stress_mises = _function("wp_stress_mises", c_int, c_void_p, c_double, _array)
_stress_tensor = _function("wp_stress_tensor", c_int, c_void_p, c_double, _array)


def stress(pressure, spacing, depths, friction=0.0, poisson=0.3, periodic=False, tensor=False,
           threads=1):
    """The von Mises stress (Pa) below a pressure [iy, ix] at each of the depths (m), as
    [depth, iy, ix]; with tensor=True the components xx yy zz xy xz yz, tension positive, as
    [depth, component, iy, ix]."""
    pressure = _field(pressure)
    dx, dy = (spacing, spacing) if np.isscalar(spacing) else spacing
    ny, nx = pressure.shape
    par = _StressPar(nx, ny, dx, dy, periodic, poisson, friction, threads)
    status = c_int()
    s = _made(_stress_new(byref(par), byref(status)), status)
    try:
        _check(_stress_load(s, pressure))
        depths = np.atleast_1d(np.asarray(depths, dtype=np.float64))
        shape = (len(depths), 6, ny, nx) if tensor else (len(depths), ny, nx)
        found = np.zeros(shape)
        for layer, depth in zip(found, depths):
            _check((_stress_tensor if tensor else _stress_mises)(s, depth, layer))
        return found
    finally:
        _stress_free(s)


# --- filters

_taps = _function("wp_filter_taps", c_int, c_int, c_double, c_double, c_double, _array)
_filter_new = _function("wp_filter_new", c_void_p, _array, c_size_t, c_int, POINTER(c_int))
_filter_free = _function("wp_filter_free", None, c_void_p)
_filter_run = _function("wp_filter_run", c_int, c_void_p, _array, c_size_t)


def taps(order, low, high, rate):
    """Taps of a Hamming-windowed band-pass from low to high, Hz."""
    h = np.empty(order + 1)
    _check(_taps(order, low, high, rate, h))
    return h


def bandpass(record, low, high, rate, order=200):
    """A record [frame] or [frame, channel], filtered; it lags by order / 2 frames."""
    h = taps(order, low, high, rate)
    out = _numbers(record)
    if out.ndim not in (1, 2):
        raise ValueError("want a record [frame] or [frame, channel]")
    channels = 1 if out.ndim == 1 else out.shape[1]
    status = c_int()
    f = _made(_filter_new(h, h.size, channels, byref(status)), status)
    try:
        _check(_filter_run(f, out, out.shape[0]))
        return out
    finally:
        _filter_free(f)


# --- particles in a record

_SEPARATE = ("delay", "pulse_duration", "gain", "spacing", "calibration", "false_alarm", "learn")
_SeparatePar = _struct(("rate", c_double), *[(name, c_double) for name in _SEPARATE])
_TRANSIT = ("time1", "time2", "diameter", "amplitude", "delay", "velocity", "time1_se",
            "time2_se", "diameter_se", "amplitude_se", "delay_se", "velocity_se", "section",
            "sources", "chi2")
_VERDICTS = ("alone", "overlap", "misfit", "unresolved", "shock", "bubble",
             "impulse", "transient")
_Transit = _struct(*[(name, c_double) for name in _TRANSIT], ("verdict", c_int),
                   ("diameter_most", c_double))
_separate_new = _function("wp_separate_new", c_void_p, POINTER(_SeparatePar), POINTER(c_int))
_separate_free = _function("wp_separate_free", None, c_void_p)
_separate_push = _function("wp_separate_push", c_int, c_void_p, _array, c_size_t)
_separate_end = _function("wp_separate_end", c_int, c_void_p)
_separate_next = _function("wp_separate_next", c_int, c_void_p, POINTER(_Transit))
_separate_reason = _function("wp_separate_reason", c_char_p, c_void_p)


def separate(record, rate, **known):
    """The wear particles in a record [frame, channel] (V) of two inductive sensors, sampled
    at rate (Hz), as duet finds them: a structured array with the columns of its table.  What
    is known may be given: delay and pulse_duration (s), gain, spacing (m), calibration
    (V s/m4), false_alarm (per sample), learn (s).  Warns where the result is doubtful."""
    record = _numbers(record)
    if record.ndim != 2 or record.shape[1] != 2:
        raise ValueError("want a record [frame, 2]")
    if set(known) - set(_SEPARATE):
        raise TypeError("want some of " + ", ".join(_SEPARATE))
    status = c_int()
    s = _made(_separate_new(byref(_SeparatePar(rate, **known)), byref(status)), status)
    rows, p = [], _Transit()

    def step(result):
        if result == _NOT_CONVERGED:
            warnings.warn(_separate_reason(s).decode(), stacklevel=3)
        elif result != _OK:
            raise Error(_separate_reason(s).decode())
        while _separate_next(s, byref(p)):
            rows.append(tuple(getattr(p, name) for name in _TRANSIT) +
                        (_VERDICTS[p.verdict], p.diameter_most))

    try:
        for at in range(0, len(record), 65536):
            step(_separate_push(s, record[at:at + 65536], len(record[at:at + 65536])))
        step(_separate_end(s))
        return np.array(rows, [(name, np.float64) for name in _TRANSIT] +
                        [("verdict", "U10"), ("diameter_most", np.float64)])
    finally:
        _separate_free(s)


# --- lives

_life_new = _function("wp_life_new", c_void_p, c_double, c_int, c_int, c_uint64, POINTER(c_int))
_life_free = _function("wp_life_free", None, c_void_p)
_life_observe = _function("wp_life_observe", c_int, c_void_p, c_double, c_double)
_life_quantiles = _function("wp_life_quantiles", c_int, c_void_p, _array, _array, c_int,
                            POINTER(c_double))


def remaining_life(t, y, threshold, levels=(0.05, 0.5, 0.95), rising=None, draws=500, seed=1):
    """Quantiles of the time left after the last of the observations y at times t until they
    reach the threshold; inf where that much mass never does."""
    t, y = _numbers(t), _numbers(y)
    if t.shape != y.shape or t.ndim != 1:
        raise ValueError("want t and y of one length")
    if not np.isfinite(y).any():
        raise ValueError("want observations")
    rising = threshold > y[np.isfinite(y)][0] if rising is None else rising
    status = c_int()
    life = _made(_life_new(threshold, 1 if rising else -1, draws, seed, byref(status)), status)
    try:
        for row in zip(t, y):
            _check(_life_observe(life, *row))
        levels = np.array(levels, dtype=np.float64)
        quantiles = np.empty_like(levels)
        _check(_life_quantiles(life, levels, quantiles, levels.size, None))
        return quantiles
    finally:
        _life_free(life)
