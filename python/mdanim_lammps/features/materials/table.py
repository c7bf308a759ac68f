# SPDX-License-Identifier: GPL-2.0-only
"""Figures of materials, each with the range in which it is found and the source of the range.

docs/materials.md is printed from here (page.py). SI units: density [kg/m^3], elasticity E [Pa], strength in tension
[Pa]; friction, restitution and damping are plain numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, fields
from typing import NamedTuple

from ...records import dataclass

CHOSEN = "chosen"
"""Source of figures for which no range is cited: they are a choice of this program."""

UNSEEN = " (figures from memory, not compared with the text)"
"""Remark on sources whose text was not at hand."""

SOURCES = {
    "A": "M. F. Ashby, Materials Selection in Mechanical Design, 4th ed., 2011, appendix A; the same ranges are in the "
         "Materials Data Book, Cambridge University Engineering Department, 2003, part II" + UNSEEN,
    "B": "US Army Corps of Engineers, Settlement Analysis, EM 1110-1-1904, 1990: elastic moduli of soils, soft clay, 50 to "
         "200 tons per square foot",
    "C": "Journal of Textiles 2016, 4614168, table 5: six denims in Kawabata's tester, which stretch by 4.7 to 5.7 % under "
         "490 N/m and are 0.80 to 1.19 mm thick",
    "D": "simetric.co.uk, Mass, weight, density or specific gravity of wood, seasoned and dry",
    "E": "The Engineering ToolBox, Young's modulus, tensile strength and yield strength of some materials",
    "F": "The Engineering ToolBox, Friction coefficients of some common materials and combinations, sliding where given",
    "G": "J. M. Gere, Mechanics of Materials, 5th ed., 2001, appendix H",
    "H": "D. Halliday, R. Resnick and J. Walker, Fundamentals of Physics, 5th ed., 1997, table 13-1",
    "I": "P. H. Gammon, H. Kiefte, M. J. Clouter and W. W. Denner, Elastic constants of artificial and natural ice samples by "
         "Brillouin spectroscopy, Journal of Glaciology: elasticity by the means of Reuss and Voigt of those at -16 deg C",
    "J": "H. Nielsen, B. U. Marr and S. Hvidt, Carbohydrate Polymers 45, 2001: G' of gels from 0.4 kPa on, E = 3 G'",
    "K": "L. J. Gibson, K. E. Easterling and M. F. Ashby, The structure and mechanics of cork, "
         "Proc. R. Soc. A 377, 1981" + UNSEEN,
    "L": "Z. Penava, D. Simic Penava and Z. Knezic, Fibres and Textiles in Eastern Europe 22(2), 2014, table 1: plain cotton "
         "cloth of 150.3 g/m^2 and 0.318 mm",
    "N": "I. Newton, Principia, scholium to the laws of motion (Motte, 1729): tightly wound wool 5/9, steel almost the same, "
         "cork a little less, glass 15/16" + UNSEEN,
    "O": "M. Winter, WebElements: gold",
    "P": "J. J. Petrovic, Mechanical properties of ice and snow, Journal of Materials Science 38, 2003",
    "R": "W. D. Callister, Materials Science and Engineering, 3rd ed., 1994: lead",
    "S": "Z. Wang, A. A. Volinsky and N. D. Gallant, J. Appl. Polym. Sci. 131, 2014, 41050: silicone (PDMS); density "
         "of its data sheet",
    "T": "G. Elert, The Physics Hypertextbook, Friction: coefficients for selected interfaces",
    "U": "Wikipedia, Ice",
    "V": "O. Anjos, H. Pereira and M. E. Rosa, Effect of quality, porosity and density on the compression properties of cork, "
         "Holz als Roh- und Werkstoff 66, 2008",
    "W": "J. F. Young et al., The Science and Technology of Civil Engineering Materials, 1998; strength along the "
         "grain: M. F. Ashby and D. R. H. Jones, Engineering Materials 2, 1986",
    CHOSEN: "a choice of this program, with no source",
}  # fmt: skip
"""Sources by their letters."""


class Figure(NamedTuple):
    """One figure of a material."""

    value: float
    low: float
    high: float
    source: str
    """Keys of SOURCES, letters one behind the other, or CHOSEN."""

    def sources(self) -> tuple[str, ...]:
        """The keys one by one."""
        return (self.source,) if self.source == CHOSEN else tuple(self.source)


@dataclass(frozen=True, slots=True)
class Material:
    """Figures of a material; None where it says nothing."""

    about: str
    density: Figure
    elasticity: Figure
    friction: Figure
    restitution: Figure | None
    """The figure of rigid and held objects."""
    damping: Figure | None
    """The figure of objects that deform."""
    strength: Figure
    color: str
    sheet: Mapping[str, Figure] = field(default_factory=dict)
    """Figures that are others in a sheet, by their words: woven cloth is much softer than its threads."""

    def figures(self) -> dict[str, Figure]:
        """All figures by their words."""
        found = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: value for name, value in found.items() if isinstance(value, Figure)}


def _f(value: float, low: float, high: float, source: str) -> Figure:
    return Figure(float(value), float(low), float(high), source)


def _own(value: float) -> Figure:
    return Figure(float(value), float(value), float(value), CHOSEN)


_k, _M, _G = 1e3, 1e6, 1e9

MATERIALS = {
    "steel": Material(
        "structural steel", _f(7850, 7800, 7900, "A"), _f(200 * _G, 190 * _G, 215 * _G, "AG"), _f(0.5, 0.42, 0.58, "FT"),
        _f(5 / 9, 5 / 9, 5 / 9, "N"), None, _f(400 * _M, 345 * _M, 580 * _M, "AH"), "#8a939b"),
    "aluminium": Material(
        "an alloy of aluminium", _f(2700, 2600, 2800, "G"), _f(70 * _G, 70 * _G, 79 * _G, "G"), _f(0.4, 0.4, 1.35, "F"),
        _own(0.5), None, _f(110 * _M, 58 * _M, 550 * _M, "AH"), "#c3c8cd"),
    "glass": Material(
        "soda-lime glass, of windows, bottles and marbles", _f(2470, 2400, 2800, "G"), _f(70 * _G, 48 * _G, 83 * _G, "G"),
        _f(0.4, 0.4, 1.0, "FT"), _f(15 / 16, 15 / 16, 15 / 16, "N"), None, _f(33 * _M, 31 * _M, 35 * _M, "A"), "#9fd0cb"),
    "iron": Material(
        "grey cast iron", _f(7200, 6970, 7370, "G"), _f(130 * _G, 83 * _G, 170 * _G, "EG"), _f(0.4, 0.15, 1.1, "F"),
        _own(0.5), None, _f(150 * _M, 69 * _M, 480 * _M, "G"), "#4b4f54"),
    "copper": Material(
        "copper", _f(8900, 8900, 8910, "G"), _f(117 * _G, 110 * _G, 124 * _G, "EG"), _f(0.36, 0.36, 0.53, "F"),
        _own(0.5), None, _f(220 * _M, 220 * _M, 830 * _M, "EG"), "#b87333"),
    "brass": Material(
        "brass", _f(8500, 8330, 8650, "G"), _f(100 * _G, 96 * _G, 125 * _G, "EG"), _f(0.44, 0.44, 0.51, "F"),
        _own(0.5), None, _f(350 * _M, 210 * _M, 620 * _M, "G"), "#c9a24a"),
    "lead": Material(
        "lead", _f(11400, 11300, 11400, "R"), _f(14 * _G, 13.8 * _G, 14 * _G, "ER"), _own(0.5),
        _own(0.2), None, _f(14 * _M, 14 * _M, 14 * _M, "R"), "#5d6068"),
    "gold": Material(
        "gold", _f(19300, 19300, 19300, "O"), _f(78 * _G, 74 * _G, 78 * _G, "EO"), _own(0.4),
        _own(0.4), None, _own(120 * _M), "#d4a937"),
    "stone": Material(
        "stone, as granite and marble", _f(2700, 2640, 2880, "G"), _f(50 * _G, 41 * _G, 97 * _G, "G"), _f(0.5, 0.3, 0.7, "T"),
        _own(0.8), None, _f(10 * _M, 5 * _M, 17 * _M, "A"), "#8f8a84"),
    "granite": Material(
        "granite", _f(2700, 2640, 2880, "G"), _f(52 * _G, 41 * _G, 97 * _G, "EG"), _f(0.5, 0.3, 0.7, "T"),
        _own(0.8), None, _f(10 * _M, 5 * _M, 17 * _M, "A"), "#8b8580"),
    "marble": Material(
        "marble, the stone; marbles are of glass", _f(2700, 2640, 2880, "G"), _f(50 * _G, 15 * _G, 97 * _G, "EG"),
        _f(0.5, 0.3, 0.7, "T"), _own(0.8), None, _f(10 * _M, 5 * _M, 17 * _M, "A"), "#e6e2dc"),
    "concrete": Material(
        "concrete", _f(2300, 2300, 2320, "GH"), _f(30 * _G, 17 * _G, 31 * _G, "GH"), _own(0.6),
        _own(0.6), None, _f(4 * _M, 2 * _M, 6 * _M, "A"), "#b4b1aa"),
    "brick": Material(
        "fired clay", _f(1900, 1900, 2100, "A"), _f(15 * _G, 10 * _G, 50 * _G, "A"), _own(0.6),
        _own(0.5), None, _f(10 * _M, 7 * _M, 14 * _M, "A"), "#a5533b"),
    "ice": Material(
        "ice of fresh water", _f(916.7, 916.7, 916.8, "U"), _f(9.2 * _G, 9.1 * _G, 9.3 * _G, "I"), _f(0.02, 0.02, 0.09, "T"),
        _own(0.5), None, _f(1.4 * _M, 0.7 * _M, 3.1 * _M, "P"), "#cfe6f2"),
    "oak": Material(
        "oak, elasticity and strength along the grain", _f(700, 590, 930, "D"), _f(11 * _G, 11 * _G, 12.4 * _G, "EW"),
        _f(0.48, 0.17, 0.48, "FT"), _own(0.5), None, _f(78 * _M, 6 * _M, 78 * _M, "W"), "#a9783f"),
    "pine": Material(
        "pine, elasticity and strength along the grain", _f(500, 370, 660, "D"), _f(9 * _G, 8.3 * _G, 9 * _G, "EW"),
        _f(0.4, 0.17, 0.48, "FT"), _own(0.5), None, _f(73 * _M, 2 * _M, 73 * _M, "W"), "#dcb67a"),
    "cork": Material(
        "cork", _f(170, 120, 200, "V"), _f(20 * _M, 13 * _M, 50 * _M, "AK"), _own(0.5),
        _f(0.5, 0.5, 5 / 9, "N"), None, _f(1.5 * _M, 0.5 * _M, 2.5 * _M, "A"), "#b98a5a"),
    "leather": Material(
        "leather", _f(930, 810, 1050, "A"), _f(200 * _M, 100 * _M, 500 * _M, "A"), _f(0.5, 0.27, 0.56, "T"),
        _own(0.4), _own(0.1), _f(23 * _M, 20 * _M, 26 * _M, "A"), "#6f4427"),
    "paper": Material(
        "paper and cardboard", _f(800, 480, 860, "A"), _f(3 * _G, 3 * _G, 8.9 * _G, "A"), _own(0.4),
        _own(0.3), _own(0.1), _f(40 * _M, 23 * _M, 51 * _M, "A"), "#f1ead8"),
    "cotton": Material(
        "cotton as rope and cloth, fibres and the air between them", _own(800), _own(500 * _M), _f(0.3, 0.3, 0.3, "F"),
        _own(0.3), _own(0.2), _own(50 * _M), "#e9e4d4",
        sheet={"density": _f(470, 470, 470, "L"), "elasticity": _f(10 * _M, 7 * _M, 13 * _M, "C")}),
    "rubber": Material(
        "natural rubber", _f(930, 920, 930, "A"), _f(2 * _M, 1.5 * _M, 2.5 * _M, "A"), _f(1.0, 1.0, 1.16, "T"),
        _own(0.75), _own(0.6), _f(25 * _M, 22 * _M, 32 * _M, "A"), "#3a3d42"),
    "silicone": Material(
        "silicone rubber", _f(1030, 1030, 1030, "S"), _f(2 * _M, 0.57 * _M, 3.7 * _M, "S"), _own(1.0),
        _own(0.7), _own(0.8), _f(4 * _M, 2.4 * _M, 5.5 * _M, "A"), "#5fb7b0"),
    "foam": Material(
        "soft foam of upholstery", _f(30, 16, 35, "A"), _f(300 * _k, 300 * _k, 1000 * _k, "A"), _own(0.6),
        _own(0.65), _own(1.5), _f(0.4 * _M, 0.24 * _M, 0.85 * _M, "A"), "#f2d98b"),
    "biscuit": Material(
        "biscuit or cookie, dry", _own(600), _own(100 * _M), _own(0.4),
        _own(0.2), None, _own(1 * _M), "#c68e4e"),
    "jelly": Material(
        "firm gelatine, as of fruit gums; a dessert has about 1 kPa [J] and folds up where it is dropped",
        _own(1000), _own(50 * _k), _own(0.2), _own(0.3), _own(0.3), _own(10 * _k), "#d3324d"),
    "clay": Material(
        "soft wet clay, as elastic as it is before it gives way; with yield-strain 0.01 dents stay",
        _own(1800), _f(5 * _M, 4.8 * _M, 19 * _M, "B"), _own(0.6), _own(0.1), _own(3.0), _own(50 * _k), "#a8876d"),
}  # fmt: skip
"""Materials by name."""

PAIRS = (
    ("ice", "ice", 0.02, 0.09, "T"),
    ("steel", "ice", 0.03, 0.03, "FT"),
    ("oak", "ice", 0.05, 0.05, "F"),
    ("steel", "steel", 0.42, 0.58, "FT"),
    ("aluminium", "steel", 0.47, 0.47, "F"),
    ("steel", "stone", 0.3, 0.7, "T"),
    ("steel", "oak", 0.2, 0.6, "T"),
    ("oak", "stone", 0.4, 0.4, "T"),
    ("oak", "concrete", 0.62, 0.62, "T"),
    ("oak", "brick", 0.6, 0.6, "T"),
    ("leather", "oak", 0.27, 0.52, "FT"),
    ("rubber", "concrete", 0.6, 1.02, "FT"),
    ("rubber", "rubber", 1.16, 1.16, "T"),
)
"""Friction of two materials as it is found, lowest and highest, and its source: to see how far off sqrt(mu_A mu_B) is."""

MEANT = {
    "wood": ("oak", "pine"), "timber": ("oak", "pine"), "metal": ("steel", "iron", "brass"), "rock": ("stone", "granite"),
    "cloth": ("cotton",), "fabric": ("cotton",), "textile": ("cotton",), "cardboard": ("paper",), "latex": ("rubber",),
    "plastic": ("rubber", "silicone"), "gelatine": ("jelly",), "sponge": ("foam",), "cookie": ("biscuit",),
}  # fmt: skip
"""Materials that are meant by words which name none."""
