"""Profiles in files: what is read is what stood there, and every fault has its line."""

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import runway_modal as rm

MAT = rm.Profile.full_mat()

#: Metres in each unit, independent of the package.
METRES = {
    "m": Fraction(1),
    "cm": Fraction(1, 100),
    "mm": Fraction(1, 1000),
    "km": Fraction(1000),
    "in": Fraction(254, 10000),
    "ft": Fraction(3048, 10000),
}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "survey.txt"


def save(path: Path, text: str | bytes) -> Path:
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def assert_fault(path: Path, line: int, *parts: str, read: Any = rm.read_csv, **how: Any) -> None:
    """InputError that begins with the file and the line and holds every part."""
    with pytest.raises(rm.InputError) as raised:
        read(path, **{"to": "in", **how})
    message = str(raised.value)
    assert message.startswith(f"{path}, line {line}: "), message
    for part in parts:
        assert part in message


# CSV: layouts


@pytest.mark.parametrize(
    ("text", "how"),
    [
        ("0,0\n1.5,2\n1.5,-3e-1\n4,0\n", {"unit": "in"}),
        ("station [in],z [in]\n0,0\n1.5,2\n1.5,-3e-1\n4,0\n", {}),
        ("station (in),z (in)\n0,0\n1.5,2\n1.5,-3e-1\n4,0", {}),
        ("station [IN] , z [ In ]\n0,0\n1.5,2\n1.5,-3e-1\n4,0\n", {"unit": "in"}),
        ("station,z\n0,0\n1.5,2\n1.5,-3e-1\n4,0\n", {"unit": ("in", "in")}),
        ("\ufeffstation [in],z [in]\r\n0,0\r\n1.5,2\r\n1.5,-3e-1\r\n4,0\r\n", {}),
        ("\ufeff0,0\n1.5,2\n1.5,-3e-1\n4,0\n", {"unit": "in"}),
        ("station [in],z [in]\r0,0\r1.5,2\r1.5,-3e-1\r4,0\r", {}),
        ("# surveyed, 1979\n\nx,z\n# 0;0\n0,0\n\n1.5,2\n1.5,-3e-1\n4,0\n\n\n", {"unit": "in"}),
        ("x;z\n0;0\n1.5;2\n1.5;-.3\n4;0\n;\n;\n", {"unit": "in"}),
        ("0\t0\n1.5\t2\n1.5\t-.3\n4\t0\n \t\n", {"unit": "in"}),
        ("  0  0\n1.5\t2\n 1.5 -.3 \n4    0\n", {"unit": "in"}),
        ("0|0\n1.5|2\n1.5|-.3\n4|0\n||\n", {"unit": "in", "delimiter": "|"}),
        ("0 0\n1.5 2\n1.5 -.3\n4 0\n", {"unit": "in", "delimiter": " "}),
        ("x [in],z [in]\n0,0\n1.5,2\n1.5,-.3\n4,0\n", {"elevation": np.int64(1)}),
        ("0;0\n1,5;2\n1,5;-,3\n4;0\n", {"unit": "in", "decimal": ","}),
        ("0 0\n1,5 2\n1,5 -,3\n4 0\n", {"unit": "in", "decimal": ","}),
        ("0\t0,0\n1,5\t2\n1,5\t-3e-1\n4\t0\n", {"unit": "in", "decimal": ","}),
        ('"x [in]";"z [in]"\n"0";"0"\n"1,5";"2"\n"1,5";-0,3\n4;0\n', {"decimal": ","}),
        ('"x, along [in]","5"" mat [in]"\n0,0\n1.5,2\n1.5,-.3\n4,0\n', {"elevation": '5" mat'}),
        ("z [in],note,x [in]\n0,,0\n2,up,1.5\n-.3,,1.5\n0,,4\n", {"station": 2, "elevation": "z"}),
        ("z [in],note,x [in]\n0,,0\n2,up,1.5\n-.3,,1.5\n0,,4\n", {"station": "x", "elevation": 0}),
        ("x [in];z, left (in)\n0;0\n1.5;2\n1.5;-.3\n4;0\n", {"elevation": "z, left"}),
        ("x [in],z [m],z [in]\n0,1,0\n1.5,1,2\n1.5,1,-.3\n4,1,0\n", {"elevation": "z [in]"}),
        ("x;z (NAVD88)\n0;0\n1.5;2\n1.5;-.3\n4;0\n", {"unit": "in", "elevation": "z (NAVD88)"}),
        ("Runway 9, 1979\n\nx;z\n0;0\n1.5;2\n1.5;-.3\n4;0\n", {"unit": "in", "skiprows": 1}),
        ("9\n27\nx;z\n0;0\n1.5;2\n1.5;-.3\n4;0\n", {"unit": "in", "skiprows": np.int8(2)}),
        ("sep=;\r\nx, along;z\r\n0;0\r\n1.5;2\r\n1.5;-.3\r\n4;0\r\n", {"unit": "in"}),
        ("SEP=|\nx|z\n0|0\n1.5|2\n1.5|-.3\n4|0\n", {"unit": "in"}),
        (b"x;H\xf6he [in]\n0;0\n1.5;2\n1.5;-.3\n4;0\n", {"unit": "in"}),
    ],
)  # fmt: skip
def test_csv_layouts(path: Path, text: str | bytes, how: dict[str, Any]) -> None:
    profile = rm.read_csv(save(path, text), "in", **how)
    assert profile == rm.Profile([0, 1.5, 1.5, 4], [0, 2, -0.3, 0])


def test_csv_tracks(path: Path) -> None:
    save(path, "s [ft],left [in],center,right [mm]\n0,0,5,0\n10,1,6,25.4\n")
    gears = {"nose": "center", "left main": 1, "right main": "right [mm]"}
    with pytest.raises(rm.InputError, match=r"line 1: column 'right \[mm\]' is in 'mm', which"):
        rm.read_csv(path, "in", unit=("ft", "in"), elevation=gears)
    tracks = rm.read_csv(path, "in", elevation={"left": 1, "right": 3})
    expected = rm.Profile([0.0, 120.0], [0.0, 1.0])
    assert tracks == {"left": expected, "right": expected}
    # Straight into a run.
    response = rm.simulate(rm.f4e().modes(0.01), tracks, 400.0)
    np.testing.assert_array_equal(response.elevation[-1], [0.0, 1.0, 1.0])


def test_csv_units_of_station_and_elevation(path: Path) -> None:
    profile = rm.read_csv(save(path, "0,0\n25.4,12.7\n"), "in", unit=("m", "mm"))
    assert profile == rm.Profile([0.0, 1000.0], [0.0, 0.5])


@pytest.mark.parametrize("to", METRES)
@pytest.mark.parametrize("unit", METRES)
def test_conversion_is_correct_to_rounding(path: Path, unit: str, to: str) -> None:
    values = sorted(np.random.default_rng(7).normal(scale=1e3, size=200).tolist())
    save(path, "".join(f"{value!r},{-value!r}\n" for value in values))
    profile = rm.read_csv(path, to, unit=unit)
    ratio = METRES[unit] / METRES[to]
    exact = [Fraction(value) * ratio for value in values]
    errors = [abs(Fraction(x) - e) / abs(e) for x, e in zip(profile.x.tolist(), exact, strict=True)]
    one_rounding = 1 in (ratio.numerator, ratio.denominator)
    assert max(errors) <= Fraction(1, 2**53) * (1 if one_rounding else 2)
    if unit == to:
        assert max(errors) == 0
    np.testing.assert_array_equal(profile.z, -profile.x)


# CSV: faults


@pytest.mark.parametrize(
    ("text", "line", "parts", "how"),
    [
        ("", 1, ["empty"], {}),
        ("\n \n# nothing\n;;\n", 1, ["empty"], {}),
        ("x,z\n", 1, ["no data", "'x,z'"], {}),
        ("0,0\n1,2\n2,1O\n", 3, ["column 1", "'1O' is not a number"], {}),
        ("x,z\n0,0\n1,\n", 3, ["'z': an empty cell is not a number"], {}),
        ("x,z\n0,0\n1,1_000\n", 3, ["'1_000' is not a number"], {}),
        ("x;z\n0;0\n1;2,5\n", 3, ["'2,5' is not a number", "decimal = ','"], {}),
        ("x;z\n0;0\n1;2.5\n", 3, ["'2.5' is not a number"], {"decimal": ","}),
        ("x;z\n0;0\n1;1.234,5\n", 3, ["'1.234,5' is not a number"], {"decimal": ","}),
        ("x,z\n0,0\n\n# a\n1,nan\n", 5, ["'z'", "'nan' is not finite"], {}),
        ("0,0\nnan,1\n", 2, ["column 0", "'nan' is not finite"], {}),
        ("0,0\n1,-inf\n", 2, ["'-inf' is not finite"], {}),
        ("0,0\n1,1e999\n", 2, ["'1e999' is not finite"], {}),
        ("0,0\n2,1\n1,2\n", 3, ["station 1.0 comes after 2.0"], {}),
        ("0,0\n2,1\n1,2\n", 3, ["station 1.0 comes after 2.0"], {"unit": "m"}),
        ("0,0\n", 2, ["no data"], {"skiprows": 1}),
        (
            "x,Elev\n0,0\n",
            1,
            ["'Elev'; did you mean 'Elev'?"],
            {"elevation": "elev"},
        ),
        (b"x;H\xf6he\n0;0\n", 1, ["the file is not in UTF-8"], {"elevation": "H\xf6he"}),
        (
            "p;x\nA;0\n",
            1,
            ["column 'p': give it as unit, or choose another"],
            {"unit": None},
        ),
        ("0;0\n1;2,5\n", 2, ["'2,5' is not a number; numbers with a decimal comma need"], {}),
        ('0;0\n1;"1,234.5"\n', 2, ["'1,234.5' is not a number"], {}),
        ("sep=,\n0,0\n1,2\n", 1, ["'sep=,' names the decimal comma"], {"decimal": ","}),
        (
            "Runway 9\nx,z\n0,0\n",
            2,
            ["where line 1 has 2: 'x,z'; to skip lines above", "skiprows"],
            {},
        ),
        ("0,0\n1\n", 2, ["1 cell(s) where line 1 has 2", "'1'"], {}),
        ("0,0\n1,2,3\n", 2, ["3 cell(s) where line 1 has 2"], {}),
        ("0,0,1,5\n1,5,2,5\n9\n", 3, ["1 cell(s)"], {}),
        ("0,0\n" + "1," * 99, 2, ["cell(s)", "1,1,…'"], {}),
        ("0\n1\n", 1, ["no column 1; there are 1, counted from 0"], {}),
        ("x,z\n0,0\n", 1, ["no column 2"], {"elevation": 2}),
        ("x,z\n0,0\n", 1, ["no column -1"], {"elevation": -1}),
        ("x,z\n0,0\n", 1, ["no column is called 'left'", "'x', 'z'"], {"elevation": "left"}),
        ("0,0\n", 1, ["no column is called 'z'", "no names"], {"elevation": "z"}),
        ("x,z,z\n0,0,0\n", 1, ["columns [1, 2]", "'z'"], {"elevation": "z"}),
        (
            "x [in],z [in]\n0,0\n",
            1,
            ["'x [in]' is in 'in', which contradicts unit = 'm'"],
            {"unit": "m"},
        ),
        ("x [furlong],z [in]\n0,0\n", 1, ["unknown unit 'furlong'"], {"unit": None}),
        ("x [in],z\n0,0\n", 1, ["no unit for column 'z'"], {"unit": None}),
        ("0,0\n", 1, ["no unit for column 0"], {"unit": None}),
        ("0,0\n1,1e200\n", 2, ["z[1]", "are allowed [in]"], {"unit": "ft"}),
        ("0,0\n1,1e308\n", 2, ["z[1] = inf is not finite"], {"unit": "km"}),
        ("0,0\n1e-200,1\n", 2, ["slopes up to 1e100"], {}),
        (b"\xff\xfex\0,\0z\0\n\0", 1, ["zero byte"], {}),
        (b"0,0\n1,2\n\0\0", 3, ["zero byte"], {}),
    ],
)
def test_csv_faults(
    path: Path, text: str | bytes, line: int, parts: list[str], how: dict[str, Any]
) -> None:
    assert_fault(save(path, text), line, *parts, **{"unit": "in", **how})


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"to": "yd"}, "to = 'yd' is none of 'in', 'ft', 'm'"),
        ({"to": None}, "to = None is none of"),
        ({"unit": "yd"}, "unit = 'yd' is none of"),
        ({"unit": ("m", "yd")}, "unit[1] = 'yd' is none of"),
        ({"unit": ("m", "m", "m")}, "is not a unit or a pair"),
        ({"unit": 3}, "unit = 3 is not a unit or a pair"),
        ({"decimal": ";"}, "decimal = ';' is none of '.', ','"),
        ({"delimiter": "||"}, "delimiter = '||' cannot separate cells"),
        ({"delimiter": ""}, "delimiter = '' cannot separate"),
        ({"delimiter": '"'}, "cannot separate"),
        ({"delimiter": 3}, "delimiter = 3 cannot separate"),
        ({"delimiter": "."}, "delimiter = '.' cannot separate"),
        ({"delimiter": ",", "decimal": ","}, "delimiter = ',' cannot separate"),
        ({"station": 1.0}, "column 1.0 is neither a name nor a whole number"),
        ({"elevation": True}, "column True is neither"),
        ({"elevation": {}}, "elevation names no column"),
    ],
)
def test_csv_arguments(path: Path, how: dict[str, Any], message: str) -> None:
    save(path, "0,0\n1,2\n")
    with pytest.raises(rm.InputError, match=re.escape(message)):
        rm.read_csv(path, **{"to": "in", "unit": "in", **how})


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    for read in (rm.read_csv, rm.read_erd):
        with pytest.raises(FileNotFoundError):
            read(tmp_path / "nowhere", "in")


# ERD

#: As profilers write it: eight-character keywords, a comma after the last number, a blank line.
ERD = """ERDFILEV2.00
      3,   4,     -1,      1,      5,       0.0250,     -1,
TITLE   Section 6: Run 1
SHORTNAMLElev.  RElev.  CElev.
LONGNAMELeft Elevation                  Right Elevation                 Center Elevation
UNITSNAMmm      mm      in
XLABEL  Distance
XUNITS  m
FORMAT  (3F9.3)
DATE    11/Apr/1997

END
   0.000   0.000   0.000
  12.700  25.400   0.250
  -1.27   2.54     1e-1
   0.000   0.000   0.000
"""


def erd(**changes: str) -> str:
    """Text of an ERD file with lines replaced that begin so."""
    lines = ERD.splitlines(keepends=True)
    for start, line in changes.items():
        key = {"line1": "ERDFILE", "line2": "      3"}.get(start, start)
        lines = [line if old.startswith(key) else old for old in lines]
    return "".join(lines)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\n\n \n"])
def test_erd(path: Path, end: str) -> None:
    save(path, "\ufeff" + ERD.rstrip("\n").replace("\n", end.rstrip(" \n") + "\n") + end)
    columns = {"nose": "Center Elevation", "left": 0, "right": "RElev."}
    tracks = rm.read_erd(path, "mm", elevation=columns)
    stations = [0.0, 25.0, 50.0, 75.0]
    for profile in tracks.values():
        np.testing.assert_allclose(profile.x, stations, rtol=1e-15)
    np.testing.assert_allclose(tracks["nose"].z, [0, 6.35, 2.54, 0], rtol=1e-15)
    np.testing.assert_array_equal(tracks["left"].z, [0, 12.7, -1.27, 0])
    np.testing.assert_array_equal(tracks["right"].z, [0, 25.4, 2.54, 0])
    assert rm.read_erd(path, "mm") == tracks["left"]


def test_erd_in_free_format(path: Path) -> None:
    text = "ERDFILEV2.00\n2 -1 -1 1 5 10 -1\nEND\n0,0,1,2\n\n3 4,5,6\n7,8\n"
    profile = rm.read_erd(save(path, text), "ft", unit=("in", "ft"), elevation=1)
    np.testing.assert_allclose(profile.x, np.arange(5) * 10 / 12, rtol=1e-15)
    np.testing.assert_array_equal(profile.z, [0, 2, 4, 6, 8])


@pytest.mark.parametrize("name", ["main;left", "a, b", 'the "left" one', "left; 'a', right"])
def test_any_name_that_is_written_is_read(path: Path, name: str) -> None:
    tracks = {name: MAT, "other": MAT}
    rm.write_csv(path, tracks, "in")
    assert rm.read_csv(path, "in", elevation={"one": name, "two": 2}) == {"one": MAT, "two": MAT}


def test_all_names_that_are_known_are_told_once(path: Path) -> None:
    for read, text, names in (
        (rm.read_csv, "x,z\n0,0\n", "'x', 'z'"),
        (rm.read_csv, "x [in],z\n0,0\n", "'x [in]', 'z'"),
        (rm.read_erd, erd(LONGNAME=""), "'LElev.', 'RElev.', 'CElev.'"),
    ):
        save(path, text)
        with pytest.raises(rm.InputError, match=rf"'up'; there are {re.escape(names)}$"):
            read(path, "in", elevation="up")


def test_erd_with_names_cut_short(path: Path) -> None:
    save(path, erd(SHORTNAM="SHORTNAMLeft    Left\n", LONGNAME="", UNITSNAM="UNITSNAMmm\n"))
    assert_fault(
        path, 11, "columns [0, 1] are all called 'Left'", read=rm.read_erd, elevation="Left"
    )
    assert_fault(path, 5, "no unit for channel 2", read=rm.read_erd, elevation=2)
    assert rm.read_erd(path, "mm").z[1] == 12.7
    # A short name does not hide behind a long one.
    assert rm.read_erd(save(path, ERD), "mm", elevation="LElev.").z[1] == 12.7


@pytest.mark.parametrize(
    ("text", "line", "parts", "how"),
    [
        ("", 1, ["'' where an ERD file has 'ERDFILEV2.00'"], {}),
        ("station,elevation\n0,0\n", 1, ["'station,elevation'"], {}),
        (erd(line1="ERDFILEV1.00\n"), 1, ["'ERDFILEV1.00'"], {}),
        ("ERDFILEV2.00", 2, ["the seven numbers NCHAN, NSAMP"], {}),
        (erd(line2="3, 4, -1, 1, 5, 0.025\n"), 2, ["3, 4, -1", "seven numbers"], {}),
        (erd(line2="3, four, -1, 1, 5, 0.025, -1\n"), 2, ["NSAMP: 'four'"], {}),
        (erd(line2="3, 4, -1, 4, 1, 0.025, -1\n"), 2, ["KEYNUM = 1", "not binary"], {}),
        (erd(line2="3, 4, -1, 2, 0, 0.025, -1\n"), 2, ["KEYNUM = 0"], {}),
        (erd(line2="0, 4, -1, 1, 5, 0.025, -1\n"), 2, ["NCHAN = 0"], {}),
        (erd(line2="1.5, 4, -1, 1, 5, 0.025, -1\n"), 2, ["NCHAN = 1.5"], {}),
        (erd(line2="1e12, 4, -1, 1, 5, 0.025, -1\n"), 2, ["NCHAN = 1e+12"], {}),
        (erd(line2="3, 0, -1, 1, 5, 0.025, -1\n"), 2, ["NSAMP = 0"], {}),
        (erd(line2="3, inf, -1, 1, 5, 0.025, -1\n"), 2, ["NSAMP = inf"], {}),
        (erd(line2="3, 4, -1, 1, 5, 0, -1\n"), 2, ["STEP = 0"], {}),
        (erd(line2="3, 4, -1, 1, 5, nan, -1\n"), 2, ["STEP = nan"], {}),
        (erd(line2="3, 4, -1, 1, 5, 1e308, -1\n"), 2, ["STEP = 1e+308", "stations leave"], {}),
        (erd(line2="3, 5, -1, 1, 5, 0.025, -1\n"), 16, ["4 samples where NSAMP = 5"], {}),
        (erd(line2="3, 3, -1, 1, 5, 0.025, -1\n"), 16, ["4 samples where NSAMP = 3"], {}),
        (erd(END=""), 16, ["without a line END"], {}),
        (ERD[: ERD.index("END") + 4], 12, ["0 samples where NSAMP = 4"], {}),
        ("ERDFILEV2.00\n1,-1,-1,1,5,1,-1\nEND", 3, ["no numbers"], {"unit": "in"}),
        (ERD.replace("25.400", ""), 14, ["2 number(s) for 3 channels"], {}),
        (ERD.replace("12.700", "12.7OO"), 14, ["channel 0: '12.7OO' is not a number"], {}),
        (ERD.replace("-1.27", "NaN"), 15, ["channel 0: 'NaN' is not finite"], {}),
        (erd(XUNITS="XUNITS  mile\n"), 8, ["unknown unit 'mile' for XUNITS"], {}),
        (erd(XUNITS=""), 11, ["no unit for XUNITS"], {}),
        (erd(UNITSNAM="UNITSNAMmil     mm      in\n"), 6, ["'mil' for channel 0"], {}),
        (erd(UNITSNAM=""), 11, ["no unit for channel 0"], {}),
        (ERD, 8, ["XUNITS is in 'm', which contradicts unit = 'in'"], {"unit": "in"}),
        (ERD, 12, ["no column is called 'nose'", "'Left Elevation'"], {"elevation": "nose"}),
        (ERD, 12, ["no column 3; there are 3"], {"elevation": 3}),
    ],
)
def test_erd_faults(
    path: Path, text: str, line: int, parts: list[str], how: dict[str, Any]
) -> None:
    assert_fault(save(path, text), line, *parts, read=rm.read_erd, **how)


# Writing, and reading back

FINITE = st.floats(-1e9, 1e9, allow_subnormal=False)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), unit=st.sampled_from(sorted(METRES)))
def test_csv_round_trip(path: Path, data: Any, unit: str) -> None:
    stations = sorted(data.draw(st.lists(FINITE, min_size=1, max_size=20)))
    heights = st.lists(FINITE, min_size=len(stations), max_size=len(stations))
    names = st.text(min_size=1, max_size=12).filter(lambda s: s.isprintable() and s == s.strip())
    chosen = data.draw(st.lists(names, min_size=1, max_size=4, unique=True))
    try:
        tracks = {name: rm.Profile(stations, data.draw(heights)) for name in chosen}
    except rm.InputError:  # a slope beyond 1e100
        return
    rm.write_csv(path, tracks, unit)
    first = path.read_bytes()
    columns = {name: i for i, name in enumerate(tracks, 1)}
    assert rm.read_csv(path, unit, elevation=columns) == tracks
    back = rm.read_csv(path, unit, elevation={name: f"{name} [{unit}]" for name in tracks})
    assert back == tracks
    rm.write_csv(path, back, unit)
    assert path.read_bytes() == first


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), step=st.floats(1e-3, 1e3), unit=st.sampled_from(sorted(METRES)))
def test_erd_round_trip(path: Path, data: Any, step: float, unit: str) -> None:
    size = data.draw(st.integers(2, 30))
    heights = st.lists(FINITE, min_size=size, max_size=size)
    names = ["left main", "left mainwheel", "nose"][: data.draw(st.integers(1, 3))]
    tracks = {name: rm.Profile(np.arange(size) * step, data.draw(heights)) for name in names}
    rm.write_erd(path, tracks, unit)
    first = path.read_bytes()
    back = rm.read_erd(path, unit, elevation={name: name for name in tracks})
    assert back == tracks
    rm.write_erd(path, back, unit)
    assert path.read_bytes() == first


@pytest.mark.parametrize(
    "stations", [[0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], np.linspace(0, 7, 701)]
)
def test_erd_stations_that_are_multiples_to_rounding(path: Path, stations: Any) -> None:
    profile = rm.Profile(stations, np.cos(stations))
    rm.write_erd(path, profile, "m")
    back = rm.read_erd(path, "m")
    np.testing.assert_array_equal(back.z, profile.z)
    assert abs(back.x - profile.x).max() <= 4 * np.spacing(profile.x[-1])
    first = path.read_bytes()
    rm.write_erd(path, back, "m")
    assert path.read_bytes() == first


def test_erd_read_in_another_unit_can_be_written(path: Path) -> None:
    back = rm.read_erd(save(path, ERD), "in", elevation={"a": 0, "b": 2})
    rm.write_erd(path, back, "in")
    assert rm.read_erd(path, "in", elevation={"a": "a", "b": "b"}) == back


def test_a_single_profile_comes_back_by_default(path: Path) -> None:
    profile = rm.Profile.one_minus_cosine(64.0, 2.0)
    rm.write_csv(path, rm.Profile.double_spall(), "in")
    assert rm.read_csv(path, "in") == rm.Profile.double_spall()
    assert path.read_bytes().startswith(b"station [in],elevation [in]\n0.0,0.0\n0.0,-1.5\n")
    rm.write_erd(path, profile, "in")
    assert rm.read_erd(path, "in") == profile


@pytest.mark.parametrize(
    ("tracks", "message"),
    [
        ([0.0, 1.0], "neither a Profile nor profiles by name"),
        ({}, "neither a Profile nor profiles by name"),
        ({"nose": None}, "tracks['nose'] = None is not a Profile"),
        ({"": MAT}, "the name '' cannot be written"),
        ({3: MAT}, "the name 3 cannot be written"),
        ({" nose": MAT}, "the name ' nose' cannot be written"),
        ({"no\nse": MAT}, "cannot be written"),
        ({"a": MAT, "b": MAT.shifted(1.0)}, "tracks['a'] and tracks['b'] have different stations"),
    ],
)
def test_what_cannot_be_written(path: Path, tracks: Any, message: str) -> None:
    for write in (rm.write_csv, rm.write_erd):
        with pytest.raises(rm.InputError, match=re.escape(message)):
            write(path, tracks, "in")
        with pytest.raises(rm.InputError, match="unit = 'yd' is none of"):
            write(path, MAT, "yd")
        assert not path.exists()


@pytest.mark.parametrize(
    ("tracks", "message"),
    [
        (MAT, "x[1] = 12.0 is not a multiple of the step 310.0"),
        (rm.Profile([1, 2, 3], [0, 0, 0]), "x[0] = 1.0 is not a multiple of the step"),
        (rm.Profile([0, 0], [0, 1]), "not a multiple of the step 0.0"),
        (rm.Profile([0], [0]), "at least two stations"),
        ({"n" * 33: rm.Profile([0, 1], [0, 1])}, "longer than 32 characters"),
    ],
)
def test_what_an_erd_file_cannot_hold(path: Path, tracks: Any, message: str) -> None:
    with pytest.raises(rm.InputError, match=re.escape(message)):
        rm.write_erd(path, tracks, "in")
    assert not path.exists()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=300)
@given(
    text=st.sampled_from([ERD, "x [m],z [mm]\n0,0\n1.5,2\n4,0\n", '"x [in]";"z"\n0;0\n1,5;2\n']),
    at=st.integers(0, 400),
    gone=st.integers(0, 30),
    put=st.binary(max_size=6) | st.text('0123456789.,;-eE_#"[]\n\r\t ', max_size=6).map(str.encode),
)
def test_a_damaged_file_is_read_or_refused_with_its_line(
    path: Path, text: str, at: int, gone: int, put: bytes
) -> None:
    data = text.encode()
    save(path, data[:at] + put + data[at + gone :])
    for read, how in ((rm.read_csv, {"decimal": ","}), (rm.read_csv, {}), (rm.read_erd, {})):
        for unit in ("in", None):
            try:
                profile = read(path, "in", unit=unit, **how)
            except rm.InputError as error:
                assert str(error).startswith(f"{path}, line ")
            else:
                assert np.isfinite([profile.x, profile.z]).all()
