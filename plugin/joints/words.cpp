// SPDX-License-Identifier: GPL-2.0-only
// The table of words.

#include "joints/words.h"

#include <iterator>

namespace mdanim {

namespace {

const char *const KINDS[] = {"weld", "ball", "hinge", "slider", "spring"};

// Kinds that a word is for, as bits.
constexpr unsigned bit(JointKind kind) { return 1U << static_cast<unsigned>(kind); }
constexpr unsigned SPRING = bit(JointKind::SPRING), WITH_AXIS = bit(JointKind::HINGE) | bit(JointKind::SLIDER),
                   WITH_DIRECTIONS = WITH_AXIS | bit(JointKind::WELD), WITH_PLACE = WITH_DIRECTIONS | bit(JointKind::BALL),
                   ALL = WITH_PLACE | SPRING;

double radius(LineWords &line, const char *what)
{
  const LineWords before = line;
  if (line.word(what) == "all") return WHOLE;
  line = before;
  return line.positive(what);
}

JointWords::Motor motor(LineWords &line)
{
  const double speed = line.number<double>("the speed of the motor");
  const LineWords before = line;
  if (line.word("the limit of the motor, or none") == "none") return {speed, HUGE_VAL};
  line = before;
  return {speed, line.positive("the limit of the motor")};
}

JointWords::Limits limits(LineWords &line)
{
  const double low = line.number<double>("the lower limit"), high = line.number<double>("the upper limit");
  if (!(low <= 0.0 && high >= 0.0 && low < high))
    line.fail("limits are from the start, so the lower one is at most 0 and the upper one at least 0, got " +
              LineWords::short_form(low) + " and " + LineWords::short_form(high));
  return {low, high};
}

struct JointWord {
  const char *word;
  unsigned kinds;
  void (*take)(JointWords &, LineWords &);
};

const JointWord WORDS[] = {
    {"at", WITH_PLACE, [](JointWords &of, LineWords &line) { of.a.at = of.b.at = line.place("the place of the joint"); }},
    {"from", SPRING, [](JointWords &of, LineWords &line) { of.a.at = line.place("the place of the first end"); }},
    {"to", SPRING, [](JointWords &of, LineWords &line) { of.b.at = line.place("the place of the second end"); }},
    {"axis", WITH_AXIS,
     [](JointWords &of, LineWords &line) {
       const Vec3 along = line.place("the axis");
       if (!(length(along) > 0.0)) line.fail("the axis has no direction");
       of.axis = unit(along);
     }},
    {"patch", ALL,
     [](JointWords &of, LineWords &line) {
       of.a.radius = radius(line, "the radius of the first patch, or all");
       of.b.radius = radius(line, "the radius of the second patch, or all");
     }},
    {"stiffness", ALL, [](JointWords &of, LineWords &line) { of.stiffness = line.positive("the stiffness"); }},
    {"frequency", ALL, [](JointWords &of, LineWords &line) { of.frequency = line.positive("the frequency"); }},
    {"arm", WITH_DIRECTIONS, [](JointWords &of, LineWords &line) { of.arm = line.positive("the arm"); }},
    {"damping", ALL, [](JointWords &of, LineWords &line) { of.damping = line.at_least_zero("the damping"); }},
    {"damping-ratio", ALL, [](JointWords &of, LineWords &line) { of.damping_ratio = line.at_least_zero("the damping ratio"); }},
    {"servo", WITH_AXIS,
     [](JointWords &of, LineWords &line) {
       const double stiffness = line.positive("the stiffness of the servo");
       of.servo = JointWords::Servo{stiffness, line.at_least_zero("the damping of the servo")};
     }},
    {"motor", WITH_AXIS, [](JointWords &of, LineWords &line) { of.motor = motor(line); }},
    {"rise", WITH_AXIS, [](JointWords &of, LineWords &line) { of.rise = line.positive("the acceleration of the motor"); }},
    {"stop", WITH_AXIS,
     [](JointWords &of, LineWords &line) {
       const double stiffness = line.positive("the stiffness of the stop"), damping = line.at_least_zero("its damping");
       of.stop = JointWords::StopSpring{stiffness, damping, line.positive("the mobility of what it stops")};
     }},
    {"friction", WITH_AXIS, [](JointWords &of, LineWords &line) { of.friction = line.at_least_zero("the friction"); }},
    {"limits", WITH_AXIS, [](JointWords &of, LineWords &line) { of.limits = limits(line); }},
    {"preload", WITH_PLACE,
     [](JointWords &of, LineWords &line) {
       const Vec3 force = line.place("the force at the start");
       of.preload = JointWords::Preload{force, line.place("the torque at the start")};
     }},
    {"breaks", ALL, [](JointWords &of, LineWords &line) { of.breaks = line.positive("the force that breaks it"); }},
    {"breaks-torque", WITH_DIRECTIONS,
     [](JointWords &of, LineWords &line) { of.breaks_torque = line.positive("the torque that breaks it"); }},
    {"length", SPRING, [](JointWords &of, LineWords &line) { of.length = line.at_least_zero("the length"); }},
    {"pulls-only", SPRING, [](JointWords &of, LineWords &) { of.pulls_only = true; }},
};

std::string listed(unsigned kinds)
{
  std::string text;
  for (const JointWord &one : WORDS)
    if (one.kinds & kinds) text += (text.empty() ? "" : " ") + std::string(one.word);
  return text;
}

int object_or_world(LineWords &line, const char *what)
{
  const LineWords before = line;
  if (line.word(what) == "world") return WORLD;
  line = before;
  return line.molecule();
}

}    // namespace

std::string JointWords::name() const
{
  const std::string other = b.object == WORLD ? "world" : std::to_string(b.object);
  return std::string(KINDS[static_cast<int>(kind)]) + " " + std::to_string(a.object) + " " + other;
}

JointWords read_joint(LineWords &line)
{
  JointWords read;
  const std::string kind = line.word("the kind of the joint");
  int number = 0;
  while (number < static_cast<int>(std::size(KINDS)) && kind != KINDS[number]) ++number;
  if (number == static_cast<int>(std::size(KINDS)))
    line.fail("there is no joint " + kind + "; kinds are weld, ball, hinge, slider and spring");
  read.kind = static_cast<JointKind>(number);
  read.a.object = line.molecule();
  read.b.object = object_or_world(line, "the second object, a molecule ID or world");
  if (read.a.object == read.b.object) line.fail("a joint is between two objects, got one twice");
  const unsigned own = bit(read.kind);
  unsigned given = 0;    // by their places in the table
  while (!line.is_at_end()) {
    const std::string word = line.word("a word");
    std::size_t n = 0;
    while (n < std::size(WORDS) && (word != WORDS[n].word || !(WORDS[n].kinds & own))) ++n;
    if (n == std::size(WORDS)) line.fail("a " + kind + " has no word " + word + "; it has " + listed(own));
    if (given & 1U << n) line.fail(word + " is given twice");
    given |= 1U << n;
    WORDS[n].take(read, line);
  }
  for (const char *needed : {"at", "from", "to", "axis"})
    for (std::size_t n = 0; n < std::size(WORDS); ++n)
      if (std::string(needed) == WORDS[n].word && WORDS[n].kinds & own && !(given & 1U << n))
        line.fail("a " + kind + " needs '" + needed + " x y z'");
  if (read.stiffness.has_value() == read.frequency.has_value())
    line.fail("give one of 'stiffness K' and 'frequency OMEGA', got " + std::string(read.stiffness ? "both" : "none"));
  if (read.damping > 0.0 && read.damping_ratio) line.fail("give one of 'damping C' and 'damping-ratio BETA', got both");
  return read;
}

std::vector<JointWords> read_joints(const std::string &file, const std::string &text)
{
  std::vector<JointWords> found;
  each_line(file, text, [&](LineWords &line) { found.push_back(read_joint(line)); });
  return found;
}

}    // namespace mdanim
