// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/liquid: a basin of liquid that solids displace, and that lifts and slows them. Wcislo 1999,
// sec. 4.

#ifndef LMP_FIX_MDANIM_LIQUID_H
#define LMP_FIX_MDANIM_LIQUID_H

#include "engine/pass_participant.h"
#include "fix.h"
#include "laws/vec3.h"
#include "liquid/automaton.h"
#include "liquid/level.h"
#include "liquid/occupancy.h"
#include "styles/particle_value.h"
#include "styles/stateful.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixMdanimLiquid : public Fix, public mdanim::PassParticipant, public mdanim::Stateful {
 public:
  FixMdanimLiquid(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void post_force(int) override;
  void end_of_step() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;
  double memory_usage() override;
  int modify_param(int, char **) override;
  void append_required_atoms(std::vector<int> &particles) const override;
  bool needs_all_atoms() override;
  double safe_displacement() const override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  // One record, of the whole: the bytes of state().
  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &records) override;

  // For liquid_c.cpp. Heights are z of every column, x fastest: the surface that solids feel, and the topmost
  // liquid (NaN where a column tells none, minus infinity where a hull keeps it dry).
  int columns() const { return automaton->cells.nx * automaton->cells.ny; }
  void surface(double *smooth, double *raw) const;
  // Everything that later steps depend on, except positions and velocities; all ranks call it together.
  std::vector<std::uint8_t> state() const;
  // Empty when the state was taken up, else why it cannot be.
  std::string set_state(const std::uint8_t *bytes, std::size_t size);
  // Content of each cell, 255 where it is solid; x fastest, then y.
  void contents(std::uint8_t *cells) const;

 private:
  enum class Model { SURFACE, PAPER };
  struct Wet {    // a particle that the liquid acts on in this step
    int i;
    mdanim::Vec3 push;
    double lambda;
  };

  struct Face {
    int corner[4];        // counter-clockwise seen from outside
    mdanim::Vec3 push;    // on each corner, in this step
  };

  int keyword(int iarg, int narg, char **arg);
  int group_bit(int iarg, const char *word);
  int width_of(const std::string &name) const;
  int *const *table_of(const std::string &name) const;
  double *writable(const std::string &name, const char *keyword);

  mdanim::Vec3 in_cells(const double *x) const;
  long count_still();
  void count_moving();
  void sum_over_ranks(mdanim::Occupancy &counted);
  void add_bodies(mdanim::Occupancy &into, bool still, double below);
  void mark_solid();
  void pour();
  long make_room();
  void raise_surface(bool just_levelled);
  void smooth();
  double shut_in_height() const;

  bool due();
  bool find_out_whether_due();
  void update_liquid();
  void flow(long changed);
  bool asleep() const { return nobody && calm && moving_solid == 0; }
  void watch(double margin);
  void couple();
  bool over_basin(const double *x) const;
  double immersed(const mdanim::Vec3 &place) const;
  void find_faces();
  mdanim::Vec3 pressure_on(const Face &face) const;
  bool looks_into_air(const mdanim::Vec3 &middle, const mdanim::Vec3 &normal) const;
  double power(double &loss) const;

  // what the command says
  std::string region_id, fill_id;
  double rho, g = -1.0, volume_asked = -1.0, level_asked = 0.0;
  bool has_level = false;
  Model model = Model::SURFACE;
  int sweeps = 0;          // per update; 0 chooses by how far solids have travelled
  int every = 4;           // steps between looks whether an update is due:
  double stride = 0.25;    // that solids travel between updates, in cells
  double period = 0.06;    // between updates while the liquid is not level, in sqrt(cell/g)
  std::uint64_t seed = 1;
  int still_bit = 0;
  std::string corners_name, faces_name, lambda_name, base_name;    // of custom properties
  int faces_width = 0;
  bool lifts = false, slows = false;
  mdanim::ParticleValue volume, gamma;

  // the basin
  mdanim::Vec3 low, cell;    // corner and edges of a cell
  double shortest;           // of its edges
  std::unique_ptr<mdanim::Automaton> automaton;
  mdanim::Leveller leveller;
  std::unique_ptr<mdanim::Occupancy> still_count, moving_count;
  std::vector<std::uint8_t> solid;      // as Automaton::displace takes it
  std::vector<std::uint8_t> blocked;    // columns whose surface is parted by something still

  // state
  bool poured = false;
  bool calm = false;                  // all is level and no solid has moved since: nothing to do
  double crossed = 0.0;               // by a shallow-water wave since liquid was last levelled, in cells
  double travel = 0.0;                // of the fastest particle near the liquid since the last update, in cells
  std::int64_t waited = 0;            // steps since the last update
  std::int64_t swept = 0;             // sweeps so far
  std::int64_t units = 0;             // cells of liquid at the start
  double work = 0.0, lost = 0.0;      // on this rank
  std::vector<double> height, eta;    // of the columns, in cells above the floor; see level.h, surface.h

  // what follows from it
  int top = 0;    // no liquid in layers from this one up
  double lowest_eta = 0.0;
  long moving_solid = 0;    // cells filled by what may move
  bool watching = false;
  bool nobody = false;    // no particle of any rank is near the liquid before the next rebuild of lists
  double watched_top = 0.0;
  double lowest = 0.0;    // particle of this rank when lists were made
  std::vector<int> watched;
  std::vector<Wet> wet;
  std::vector<Face> faces;                    // of the watched particles
  std::vector<int> face_of, face_of_first;    // those of watched[n]: face_of[face_of_first[n]] …
  bigint asked = -1;                          // step for which it is known
  bool is_due = false;
  double last_power = 0.0, last_loss = 0.0;
  double automaton_seconds = 0.0, occupancy_seconds = 0.0, coupling_seconds = 0.0;
};

}    // namespace LAMMPS_NS

#endif
