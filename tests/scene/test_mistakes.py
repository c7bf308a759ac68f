# SPDX-License-Identifier: GPL-2.0-only
"""Reading scenes with mistakes: line, column, words of the message, words of the way out."""

import time

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.parse import parse_scene
from scene_parts import CONTROL, pool, text

HALF = "fill from (0, 0, 0) m to (0.5, 1, 1) m"

# --- mistakes: line, column, words of the message, words of the way out -----------------------------------

MISTAKES = [
    ("a model that was", pool("volume 1 l model pressure"), 3, 20, "not one of the choices of model any more", "model waves"),
    ("mistyped unit", text(mass="1.5 kgg"), 4, 12, "'kgg' is not a unit of mass", "did you mean 'kg'?"),
    ("a shape of another program", text(shape="ball radius 2 cm"), 2, 9,
     "shape cannot be followed by 'ball'", "did you mean 'sphere'?"),
    ("sizes with an x between", text(shape="cuboid 40 x 10 x 2 cm"), 2, 9,
     "shape cannot be followed by 'cuboid'", "did you mean 'box'?"),
    ("foreign unit", text(mass="3 lb"), 4, 10, "'lb' is not a unit of mass", "units that fit: kg g t"),
    ("wrong dimension", text(mass="3 m"), 4, 8, "mass must be a mass, found 3 m, a length", "kg"),
    ("wrong dimension of a let", text("let e = 3 kg\n", elasticity="e"), 6, 14,
     "elasticity must be a pressure, found e = 3 kg", "kPa"),
    ("angle as mass", text(mass="20 deg"), 4, 8, "mass must be a mass, found 0.349066 rad", "kg"),
    ("rate as spin", text(spin="(0, 0, 2) Hz"), 6, 8, "spin must be an angular speed", "rpm"),
    ("a word that other programs have", text(mass="1 kg bounce 0.5"), 4, 13, "bounce is not supported yet", "set damping"),
    *((f"{word} outside of all", f"{word} a b\n" + text(), 1, 1, f"{word} is not supported yet", way_out) for word, way_out in
      (("motion", "velocity"), ("axle", "joint hinge"), ("break", "pieces"), ("fracture", "pieces"), ("tear", "tear-strain"),
       ("balloon", "inflate"))),
    ("a joint without its word", "weld a b\n" + text(), 1, 1, "weld is a kind of joint", "write joint weld A B { ... }"),
    ("ground that is not a floor", "ground y 0 m\n" + text(), 1, 8, "ground cannot be followed by 'y'", "write ground z 0 m"),
    ("colour with a hyphen", text(color="light-blue"), 6, 9, "'light-blue' is not a colour", "did you mean 'lightblue'?"),
    ("a camera that only looks", text() + "render { camera look ball }\n", 8, 17, "'from' is missing in camera, found 'look'",
     "write camera from (4, -4, 2) m look NAME, or camera follow NAME"),
    ("a unit before its number", text().replace("time 3 s", "time 3 s friction 0.5 fps 30"), 7, 37, "'30' follows another value",
     "a unit comes behind its number: write frames, then 30 fps"),
    ("a label with times", text() + 'render { label ball "x" from 0 s }\n', 8, 25, "'from' cannot follow here; label is complete",
     "a label has no times"),
    ("energy of an object", text() + "record ball.energy\n", 8, 8, "energy is not a quantity of ball",
     "write kinetic, potential or elastic"),
    ("negative", text(mass="-2 kg"), 4, 8, "mass must be > 0, found -2 kg", ""),
    ("zero", text(shape="sphere 0 m"), 2, 16, "r of sphere must be > 0, found 0 m", ""),
    ("negative edge", text(shape="box (1, -1, 1) m"), 2, 13, "ly of shape box must be > 0", ""),
    ("negative through a let", text("let a = 2\n", mass="-a kg"), 5, 8,
     "mass must be > 0, found -a kg = -2 kg", ""),
    ("overflow", text(mass="1e300*1e300 kg"), 4, 8, "mass is not a finite number", ""),
    ("huge literal", text(mass="1e999 kg"), 4, 8, "1e999 is too large a number", ""),
    ("huge power", text(mass="9^9^9^9"), 4, 11, "the result is not a finite number", ""),
    ("division by zero", text(mass="1/0 kg"), 4, 9, "division by zero", ""),
    ("root of a negative", text(mass="sqrt(-1)"), 4, 8, "sqrt needs a number >= 0", ""),
    ("unlike sum", text(mass="1 kg + 2 m"), 4, 13, "cannot add a mass and a length (1 kg, 2 m)", ""),
    ("two units", text("let a = 1 m\n", shape="sphere a m"), 3, 18, "the value has a unit already",
     "leave out 'm'"),
    ("calculating behind a unit", text(mass="2 kg * 3"), 4, 15, "a unit is expected after '*'", "brackets"),
    ("a function behind a unit", text(mass="2 kg*sqrt(2)"), 4, 13, "'sqrt' is not a unit", "brackets"),
    ("frame rate", text().replace("time 3 s", "time 3 s fps 25"), 7, 20, "follows another unit", "frames, then 25 fps"),
    ("units side by side", text(mass="2 kg m"), 4, 13, "the unit 'm' follows another unit", "kg*m"),
    ("unknown name", text("let rho = 1\n", mass="roh kg"), 5, 8, "'roh' has no value", "did you mean 'rho'?"),
    ("name before its let", text(mass="a kg") + "let a = 3\n", 4, 8, "'a' is used before its let", "line 8"),
    ("unit without number", text(mass="kg"), 4, 8, "'kg' is a unit", "1 kg"),
    ("unknown function", text(mass="sqr(4)"), 4, 8, "'sqr' is not a function", "did you mean 'sqrt'?"),
    ("too few arguments", text(mass="rand(1)"), 4, 8, "rand takes two numbers", ""),
    ("short vector", text(position="(1, 2) m"), 3, 12, "position is a vector (x, y, z), found 2 numbers",
     "position (0, 0, 1) m"),
    ("decimal comma in a vector", text(position="(0,5, 1, 2) m"), 3, 12, "found 4 numbers", "with a point"),
    ("decimal comma", text(mass="1,5 kg"), 4, 9, "',' cannot follow here", "with a point"),
    ("a word before a value", text(shape="sphere radius 9 cm"), 2, 16, "'radius' is not written before its value", "alone"),
    ("vector without brackets", text(position="0 0 1 m"), 3, 14, "'0' follows another value", "(x, y, z)"),
    ("number for a vector", text("gravity -9.81\n"), 1, 9,
     "gravity is a vector (gx, gy, gz), found the number -9.81", "(0, 0, -9.81)"),
    ("vector for a number", text(mass="(1, 2, 3) kg"), 4, 8, "mass is a number, found the vector", ""),
    ("vector in a vector", text(position="((1, 2), 3, 4) m"), 3, 13, "a vector cannot stand inside a vector",
     ""),
    ("open bracket", text(position="(0, 0, 1 m"), 3, 12, "this ( is not closed", "add a )"),
    ("bracket too many", text(position="(0, 0, 1)) m"), 3, 21, "')' cannot follow here", "closes nothing"),
    ("missing operand", text(mass="2 + 3*"), 4, 14,
     "a number is missing after '*', found the end of the line", ""),
    ("mod as a function", text(mass="mod(3, 2) kg"), 4, 8, "a number is expected here, found 'mod'", "k mod 2"),
    ("nothing", text(mass=""), 4, 3, "nothing follows mass", "e.g. mass 2 kg"),
    ("equals sign", text(mass="= 2 kg"), 4, 8, "no '=' is needed after mass", "e.g. mass 2 kg"),
    ("semicolon", text(mass="2 kg;"), 4, 12, "';' cannot follow here", "without ;"),
    ("curly quotes", text(color="\u201cred\u201d"), 6, 9, "color needs a colour", ""),
    ("odd sign", text(mass="\u22122 kg"), 4, 8, "a number is expected here", "plain minus"),
    ("mistyped setting", text(mass=None, mas="2 kg"), 5, 3, "'mas' is not a setting of object",
     "did you mean 'mass'?"),
    ("capital letter", text(mass=None, Mass="2 kg"), 5, 3, "'Mass' is not a setting of object",
     "did you mean 'mass'?"),
    ("shape as a setting", text(box="(1, 1, 1) m"), 6, 3, "'box' is not a setting of object",
     "write shape box"),
    ("setting of another block", text(level="1 m"), 6, 3, "'level' cannot stand inside object", "liquid"),
    ("setting outside", "mass 2 kg\n" + text(), 1, 1, "'mass' cannot stand outside of all blocks", "object"),
    ("word of others outside", "duration 2 s\n" + text(), 1, 1, "'duration' is not a word", "'time'? it belongs in control { }"),
    ("assignment without let", "a = 3\n" + text(), 1, 1, "'a' is not a word of the scene language",
     "write let a ="),
    ("mistyped shape", text(shape="spere 1 m"), 2, 9, "shape cannot be followed by 'spere'",
     "did you mean 'sphere'?"),
    ("mistyped word in a form", text(elasticity="sprng 2 N/m"), 5, 14,
     "elasticity cannot be followed by 'sprng'", "did you mean 'spring'?"),
    ("nothing behind a hyphen", text(**{"tear-strain": ""}), 6, 3, "nothing follows tear-strain", "e.g. tear-strain 0.1"),
    ("sheet without thickness", text(shape="sheet (1, 1) m"), 2, 23, "'thickness' is missing in shape, found the end of the line",
     "write shape sheet (lx, ly) thickness t"),
    ("number for a torque", text(torque="5 N*m"), 6, 10, "torque is a vector (tx, ty, tz), found the number 5 N*m", "N*m"),
    ("missing word in a form", text(orientation="axis (0, 0, 1) 20 deg"), 6, 30,
     "'angle' is missing in orientation, found '20'", "e.g. orientation"),
    ("no direction", text(orientation="axis (0, 0, 0) angle 1"), 6, 20,
     "the axis of a rotation needs a direction", ""),
    ("no rotation", text(orientation="matrix (1, 0, 0) (0, 1, 0) (0, 0, 2)"), 6, 3,
     "this matrix is not a rotation", "axis"),
    ("mirror", text(orientation="matrix (1, 0, 0) (0, 1, 0) (0, 0, -1)"), 6, 3,
     "this matrix is not a rotation", ""),
    ("fat torus", text(shape="torus 1 cm 2 cm"), 2, 20, "thinner than the ring", "torus R r"),
    ("missing mesh", text(shape='mesh "gone.stl"'), 2, 14, "the mesh file 'gone.stl' is not there",
     "relative"),
    ("strange mesh", text(shape='mesh "gone.doc"'), 2, 14, "a mesh is an STL, OBJ or PLY file", ""),
    ("mesh without quotes", text(shape="mesh gone.stl"), 2, 14, "needs a text in quotes", ""),
    ("unknown face", text(hold="face x"), 6, 13, "'x' is not one of the choices of hold", "did you mean"),
    ("empty held box", text(hold="within box (0, 0, 0) to (1, 1, 0) m"), 6, 32, "no extent along z",
     "lower corner"),
    ("colour as a comment", text(color="#ff0000"), 6, 3, "nothing follows color", "in quotes"),
    ("unknown colour", text(color="rde"), 6, 9, "'rde' is not a colour", "did you mean 'red'?"),
    ("no shape", text(shape=None), 1, 8, "object ball has no shape", "e.g. shape sphere"),
    ("no mass", text(mass=None), 1, 8, "object ball has no mass or density", "e.g. mass 2 kg"),
    ("mass and density", text(density="3 kg/m^3"), 6, 3, "both mass and density", "scene:4:3"),
    ("setting twice", text(mass="2 kg\n  mass 3 kg"), 5, 3, "mass is given twice in object ball",
     "scene:4:3"),
    ("question twice", text('question "a"\nquestion "b"\n'), 2, 1, "question is given twice", "scene:1:1"),
    ("size of a texture", text(texture="wood size 0 cm"), 6, 21, "width of texture must be > 0", "texture checker size"),
    ("unknown camera", text() + "render { camera back }\n", 8, 22, "'from' is missing in camera",
     "or camera top|side|front|follow NAME"),
    ("camera that follows nothing", text() + "render { camera follow }\n", 8, 17, "nothing follows follow",
     "write camera follow NAME"),
    ("name twice", text() + text().replace(CONTROL, ""), 8, 8, "the name ball is given twice", "scene:1:8"),
    ("name of a liquid before", pool().replace(CONTROL, "") + text().replace("ball", "w"), 6, 8, "the name w is given twice",
     "scene:2:8"),
    ("reserved name", text().replace("ball", "energy"), 1, 8, "an object cannot be called energy", ""),
    ("two controls", text() + CONTROL, 8, 1, "a second control block", "scene:7:1"),
    ("no control", text().replace(CONTROL, ""), 1, 1, "the scene has no control block",
     "control { time 3 s }"),
    ("no time", text().replace("time 3 s", ""), 7, 1, "control has no time", "e.g. time 3 s"),
    ("no frame", text().replace("3 s", "1 ms"), 7, 16, "not one frame", ""),
    ("fraction as seed", text().replace("3 s", "3 s seed 1.5"), 7, 25,
     "seed must be a whole number >= 0, found 1.5", ""),
    ("random seed", text().replace("3 s", "3 s seed rand(1, 9)"), 7, 25, "the seed cannot be random",
     "seed 7"),
    ("bad accuracy", text().replace("3 s", '3 s accuracy "eror 2 %"'), 7, 29,
     "'\"eror 2 %\"' is not one of the choices of accuracy", "known here: preview, balanced, reference"),
    ("target in a scene", text().replace("3 s", '3 s accuracy "error 2 %"'), 7, 29,
     "'\"error 2 %\"' is not one of the choices of accuracy any more", 'study SCENE --target "2 %"'),
    ("target without quotes", text().replace("3 s", "3 s accuracy error 2 %"), 7, 29,
     "'error' is not one of the choices of accuracy any more", 'study SCENE --target "2 %"'),
    ("empty scene", CONTROL, 1, 1, "neither an object nor a liquid", "object NAME"),
    ("no name", text().replace("ball", ""), 1, 9, "a name is missing after object", "e.g. object ball {"),
    ("name of control", text().replace("control", "control x"), 7, 9, "control has no name", ""),
    ("mistyped block", text().replace("object", "objekt"), 1, 1, "'objekt' is not a word",
     "did you mean 'object'?"),
    ("object never closed", text().replace("}\ncontrol", "\ncontrol"), 1, 1,
     "object ball, opened at line 1, is not closed before 'control' at line 7", "add a }"),
    ("file ends in a block", text().replace(" s }", " s"), 7, 1,
     "control, opened at line 7, is never closed", "add a }"),
    ("setting behind an open block", text().replace("}\ncon", "gravity (0, 0, 0)\ncon"), 1, 1,
     "is not closed before 'gravity'", ""),
    ("brace too many", text() + "}\n", 8, 1, "this } closes nothing", ""),
    ("no brace", text().replace("{\n  shape", "\n  shape"), 1, 13, "a { is missing after object ball", ""),
    ("open text", 'title "hello\n' + text(), 1, 7, "this text is never closed", ""),
    ("text without quotes", "title hello\n" + text(), 1, 7, "title needs a text in quotes, found 'hello'",
     'e.g. title "'),
    ("let twice", text("let a = 1\nlet a = 2\n"), 2, 5, "'a' is given twice", "scene:1:5"),
    ("let of a function", text("let sin = 1\n"), 1, 5, "'sin' is a word of the language", ""),
    ("let without value", text("let a 5\n"), 1, 7, "an = is missing after let a", "let a = 3"),
    ("fraction of a round", text("repeat i in 1 .. 2.5 { }\n"), 1, 18,
     "repeat counts in whole numbers, found 2.5", ""),
    ("repeat without in", text("repeat i 1 .. 2 { }\n"), 1, 10, "'in' is missing after repeat i", ""),
    ("repeat without dots", text("repeat i in 1 2 { }\n"), 1, 15, "'..' is missing in repeat i, found '2'",
     "1 .. 10"),
    ("loop name twice", text("let i = 1\nrepeat i in 1 .. 2 { }\n"), 2, 8, "'i' is given twice", ""),
    ("liquid in a repeat", text("repeat i in 1 .. 2 { liquid w { } }\n"), 1, 22,
     "liquid cannot stand in a repeat", ""),
    ("index is not a whole number", text().replace("ball", "ball[0.5]"), 1, 13,
     "an index is a whole number, found 0.5", ""),
    ("open index", text().replace("ball", "ball[1"), 1, 15, "a ] is missing", ""),
    ("two million objects", text("repeat i in 1 .. 2*10^6 { object b[i] { } }\n"), 1, 1,
     "about 2 000 000 objects; the most is 1 000 000", ""),
    ("endless empty repeat", text("repeat i in 1 .. 10^12 { }\n"), 1, 1,
     "the repeats of this scene run about 1e12 rounds", ""),
    ("nested million",
     text("repeat i in 1 .. 1001 { repeat j in 1 .. 1000 { object b[i*1000 + j] { } } }\n"), 1, 1,
     "about 1 000 000 objects", ""),
    ("liquid without gravity", pool(gravity=""), 1, 8, "a liquid needs gravity along -z", "-9.81"),
    ("liquid on a slope", pool(gravity="gravity (1, 0, -9) m/s^2\n"), 1, 9,
     "a liquid needs gravity along -z, found (1, 0, -9) m/s^2", ""),
    ("two liquids", pool().replace(CONTROL, "") + pool(gravity="").replace("liquid w", "liquid v"), 6, 1,
     "a second liquid block", "scene:2:1"),
    ("too much liquid", pool("volume 2 m^3"), 3, 10,
     "2 m^3 of liquid do not fit into the basin of 1 m^3", ""),
    ("level outside", pool("level 2 m"), 3, 9, "the level 2 m is outside the basin", ""),
    ("fill sticks out", pool("volume 1 l fill from (0, 0, 0) m to (0.5, 1, 1.5) m"), 3, 39,
     "the upper corner of fill lies outside the basin: (0.5, 1, 1.5) m", "the basin goes from (0, 0, 0) to (1, 1, 1) m"),
    ("fill upside down", pool("volume 1 l fill from (0, 1, 0) m to (0.5, 0, 1) m"), 3, 39,
     "the part that is filled has no extent along y", "lower corner"),
    ("too much for fill", pool("volume 6 l fill from (0, 0, 0) m to (0.1, 0.5, 0.1) m"), 3, 10,
     "6 l of liquid do not fit into the fill region of 5 l", "larger fill region"),
    ("pool without fill", pool("level 0.5 m pool from (0, 0, 0) m to (1, 1, 0.2) m"), 3, 15,
     "all of the basin is filled, the pool too", "write fill"),
    ("pool with a volume", pool(f"volume 1 l {HALF} pool from (0.5, 0, 0) m to (1, 1, 0.2) m"), 3, 53,
     "a pool is beside what is filled to a level", "in place of volume"),
    ("pool above the level", pool(f"level 0.1 m {HALF} pool from (0.5, 0, 0) m to (1, 1, 0.2) m"), 3, 54,
     "the pool goes up to 20 cm, above the level of 10 cm", ""),
    ("pool outside", pool(f"level 0.5 m {HALF} pool from (0.5, 0, 0) m to (2, 1, 0.2) m"), 3, 54,
     "is not all in the basin", "the basin goes from (0, 0, 0) to (1, 1, 1) m"),
    ("pool in what is filled", pool(f"level 0.5 m {HALF} pool from (0.4, 0, 0) m to (1, 1, 0.2) m"), 3, 54,
     "the pool and the part that is filled overlap", ""),
    ("level outside fill", pool("level 0.1 m fill from (0, 0, 0.2) m to (1, 1, 1) m"), 3, 9,
     "the level 10 cm is outside the fill region, which goes from 20 cm to 1 m", ""),
    ("calm without waves", pool("level 0.5 m model surface calm 3 s"), 3, 29, "model surface has no calm", "write model waves"),
    ("ground rubs without waves", pool("level 0.5 m model surface manning 0.03"), 3, 29, "model surface has no manning",
     "write model waves"),
    ("roughness as a length", pool("level 0.5 m manning 3 mm"), 3, 23, "manning must be a plain number, found 3 mm",
     "leave out the unit"),
    ("too rough", pool("level 0.5 m manning 3"), 3, 23, "manning is too large: it goes from 1e-4 to 1, found 3", "0.03 gravel"),
    ("smooth by a zero", pool("level 0.5 m manning 0"), 3, 23, "manning must be > 0, found 0", "e.g. manning 0.03"),
    ("drops without waves", pool("level 0.5 m model surface drops 0.5"), 3, 29, "model surface has no drops",
     "write model waves"),
    ("too many drops", pool("level 0.5 m drops 1.5"), 3, 21, "drops is too large: it goes up to 1, found 1.5",
     "1 lets all of it fly"),
    ("sweeps of waves", pool("level 0.5 m sweeps 3"), 3, 15, "model waves has no sweeps", "or write model surface"),
    ("basin upside down", pool("volume 1 l basin from (0, 0, 1) m to (1, 1, 0) m"), 3, 40,
     "the basin has no extent along z", "lower corner"),
    ("outside the walls", text("walls from (2, 2, 2) m to (3, 3, 3) m\n"), 4, 12,
     "ball stands outside the walls", "(2, 2, 2)"),
    ("unknown effect", text("effects { contct off }\n"), 1, 11, "'contct' is not a setting of effects",
     "did you mean 'contact'?"),
    ("unknown switch", text("effects { contact of }\n"), 1, 19, "'of' is not one of the choices of contact",
     "did you mean 'off'?"),
    ("expect of no object", text("expect bal.position.z = 1 m\n"), 1, 8, "no object is called bal",
     "did you mean 'ball'?"),
    ("contact with the liquid's name", pool() + "contact w basin { friction 0.1 }\n", 7, 9,
     "w is the liquid; what objects touch is its basin", "write basin"),
    ("unknown quantity", text("expect ball.positon.z = 1 m\n"), 1, 8, "positon.z is not a quantity of ball",
     "did you mean 'position.z'?"),
    ("part of a quantity", text("expect ball.z = 1 m\n"), 1, 8, "z is not a quantity of ball",
     "did you mean 'position.z'?"),
    ("unknown word behind a setting", text(mass="2 kg wobbliness 0.5"), 4, 13,
     "'wobbliness' cannot follow here", "no setting here is called wobbliness"),
    ("word behind a setting", text().replace("time 3 s", "time 3 s friktion 0.5"), 7, 20,
     "'friktion' cannot follow here",
     "did you mean 'friction'?"),
    ("no quantity", text("expect ball = 1 m\n"), 1, 8, "expect ball names no quantity", "ball.position.z"),
    ("draft without liquid", text("expect ball.draft = 1 m\n"), 1, 8, "ball.draft needs a liquid", ""),
    ("too late", text("expect ball.position.z at 5 s = 1 m\n"), 1, 27,
     "5 s lies outside the run, which ends at 3 s", ""),
    ("expect in kilograms", text("expect ball.position.z = 1 kg\n"), 1, 26,
     "ball.position.z is a length, found 1 kg, a mass", "cm"),
    ("negative tolerance", text("expect ball.position.z = 1 m +- -1 m\n"), 1, 33,
     "the tolerance must be >= 0", ""),
    ("camera looks at no object", text() + "render { camera from (1, 1, 1) m look bal }", 8, 39,
     "no object is called bal", "did you mean 'ball'?"),
    ("camera in itself", text() + "render { camera from (1, 1, 1) m look (1, 1, 1) m }", 8, 39,
     "the camera stands where it looks", ""),
    ("camera path without times",
     text() + "render { camera from (1, 1, 1) m look ball\ncamera 1 s from (1, 1, 1) m look ball }", 8, 10,
     "this one has no time", "camera 2 s"),
    ("camera runs back",
     text() + "render { camera 1 s from (1, 1, 1) m look ball\ncamera 1 s from (1, 1, 1) m look ball }", 9,
     8, "the times of the cameras must rise", ""),
    ("contact too soft", text().replace("time 3 s", "time 3 s contact-stiffness 0.01"), 7, 38, "goes from 0.1 to 100, found 0.01",
     "4 halves"),
    ("contact too stiff", text("let f = 1e3\n").replace("time 3 s", "time 3 s contact-stiffness f"), 8, 38,
     "goes from 0.1 to 100, found 1000", "4 halves"),
    ("contact with a unit", text().replace("time 3 s", "time 3 s contact-stiffness 4 N/m"), 7, 38, "contact-stiffness must be",
     ""),
    ("contact with the wrong dash", text().replace("time 3 s", "time 3 s\n contact_stiffness 4"), 8, 2, "contact_stiffness",
     "did you mean 'contact-stiffness'?"),
    ("a let called as a unit", text("let r = 10 cm\nlet t = 2 cm\n", shape="cylinder r t"), 4, 20,
     "nothing follows the unit t: a name right after a value is its unit", "for the value of let t write (t)"),
    ("giant picture", text() + "render { size (99999, 1) }", 8, 15, "is too large", "16384"),
]  # fmt: skip


@pytest.mark.parametrize(("scene", "line", "column", "words", "hint"), [m[1:] for m in MISTAKES], ids=[m[0] for m in MISTAKES])
def test_mistake(scene, line, column, words, hint):
    """Tell the place, the cause with the value found, and a way out."""
    with pytest.raises(SceneError) as error:
        parse_scene(scene)
    first = error.value.problems[0]
    assert words in first.message
    assert hint in first.hint
    assert (first.line, first.column) == (line, column), str(first)


@pytest.mark.parametrize("scene", [m[1] for m in MISTAKES], ids=[m[0] for m in MISTAKES])
def test_one_mistake_is_one_problem(scene):
    """A single mistake does not set off others."""
    with pytest.raises(SceneError) as error:
        parse_scene(scene)
    assert len(error.value.problems) == 1, str(error.value)


def test_all_problems_in_one_pass():
    """Go on after a bad line and after a bad block."""
    scene = text(mass="2 kgg", shape="spere 1 m").replace("time 3 s", "time 3 kg\n frams 30 fps\n seed -1") + "objct b { }\n"
    with pytest.raises(SceneError) as error:
        parse_scene(scene)
    assert [p.line for p in error.value.problems] == [2, 4, 7, 8, 9, 10, 10, 10, 10, 10][: len(error.value.problems)]
    assert len(error.value.problems) >= 6


@pytest.mark.parametrize(
    ("control", "columns"),
    [
        pytest.param("time 3 sec  fps 20  friktion 0.3", {18, 23, 31}, id="unknown words behind a unit"),
        pytest.param("time 3 s  accuracy fine  friktion 3  seed -1", {30, 36, 53}, id="behind a choice"),
        pytest.param("time 3 s  friktion 0.3 fps 20  frames 30 fsp", {21, 34, 52}, id="behind another unknown word"),
    ],
)
def test_all_problems_of_a_line_in_one_pass(control, columns):
    """Words that a block does not have are told too where they stand behind a bad value on the same line."""
    with pytest.raises(SceneError) as error:
        parse_scene(text().replace(CONTROL, f"control {{ {control} }}\n"))
    assert {p.column for p in error.value.problems} == columns, str(error.value)


def test_names_in_pictures_are_told_beside_other_problems():
    """Whatever else of the block cannot be read."""
    for wrong in ("label ball hello", "size (0, 3)"):
        with pytest.raises(SceneError) as error:
            parse_scene(text() + f"render {{ plot bal.speed  trail bal  {wrong} }}\n")
        told = [p.message for p in error.value.problems]
        assert told[:2] == ["no object is called bal"] * 2 and len(told) == 3, told


def test_a_mistake_in_a_repeat_is_told_once():
    """Name the first round in which it happens."""
    body = text(mass="(3 - i) kg").replace("object ball", "object ball[i]").replace(CONTROL, "")
    with pytest.raises(SceneError) as error:
        parse_scene(f"repeat i in 1 .. 1000 {{\n{body}}}\n" + CONTROL)
    (problem,) = error.value.problems
    assert problem.message == "mass must be > 0, found (3 - i) kg = 0 kg (with i = 3)"


def test_a_spoiled_let_is_told_once():
    """Mistakes that follow from a bad let are not reported again."""
    with pytest.raises(SceneError) as error:
        parse_scene(text("let a = 1/0\nlet b = a + 1\n", mass="b kg"))
    assert len(error.value.problems) == 1


def test_many_problems_are_counted():
    """Show fifty problems and count the rest."""
    with pytest.raises(SceneError) as error:
        parse_scene("nonsense here\n" * 200 + text())
    assert len(error.value.problems) == 51
    assert error.value.problems[-1].message == "150 more problems"


@pytest.mark.parametrize("expression", [
    pytest.param("(" * 50_000 + "1" + ")" * 50_000, id="brackets"),
    pytest.param("-" * 50_000 + "1", id="signs"),
    pytest.param("+".join("a" * 20_000), id="a long sum"),
    pytest.param("^".join("2" * 20_000), id="a tower"),
    pytest.param("sqrt(" * 20_000 + "1" + ")" * 20_000, id="calls"),
    pytest.param("9" * 50_000, id="digits"),
    pytest.param("2 " + "*".join(["m"] * 50_000), id="units"),
])  # fmt: skip
def test_monstrous_expression_is_refused(expression):
    """Neither hang nor run out of stack."""
    begin = time.process_time()
    with pytest.raises(SceneError):
        parse_scene(text("let a = 1\n", mass=expression))
    assert time.process_time() - begin < 10.0


def test_monstrous_nesting_is_refused():
    """Refuse repeats and open blocks without measure, quickly."""
    for scene in ("repeat i in 1 .. 2 {" * 5000, "object a {" * 5000, "{" * 50_000, "}" * 50_000):
        with pytest.raises(SceneError):
            parse_scene(scene)
