// The committed state stored and restored. The order of the rows and of the pairs belongs to it,
// since it is the order of the sums, and so do the places of the particles when the list was made:
// they decide when it is made anew.
#pragma once

#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/native/soft_spheres.hpp"

namespace fluxpact {

/// Of the layout below.
inline constexpr int native_state_version = 3;

/// Below which the indices of a block stay.
struct StateLimits {
  int own = 0;  ///< particles of the block
  int all = 0;
  int laws = 0;
  int surfaces = 0;
};

// The whole numbers of pairs, and of a row of each other list, each with its limit.
template <class Place, class Visit>
void visit_columns(const PairList<Place>*, const StateLimits& limits, const PairColumns& columns,
                   const Visit& visit) {
  constexpr bool in_block = std::is_same_v<PairList<Place>, InnerList>;
  visit("other", &PairList<Place>::other, in_block ? limits.own : limits.all);
  visit("mine", &PairList<Place>::mine, limits.own);
  if (columns.shift) visit("shift", &PairList<Place>::shift, 27);
  if (columns.law) visit("law", &PairList<Place>::law, limits.laws);
}
template <class Visit>
void visit_columns(const NearPlane*, const StateLimits& limits, const Visit& visit) {
  visit("mine", &NearPlane::mine, limits.own);
  visit("side", &NearPlane::side, 6);
  visit("law", &NearPlane::law, limits.laws);
}
template <class Visit>
void visit_columns(const SurfaceTouch*, const StateLimits& limits, const Visit& visit) {
  visit("surface", &SurfaceTouch::surface, limits.surfaces);
  visit("feature", &SurfaceTouch::feature, 0x1p31);
  visit("mine", &SurfaceTouch::mine, limits.own);
  visit("law", &SurfaceTouch::law, limits.laws);
}

// The kinds of contacts: a name, and where a block holds their rows and springs.
struct InnerPairs {
  static constexpr auto name = "inner";
  static constexpr bool shifted = false;
  static auto& rows(auto& block) { return block.inner; }
  static auto& close(auto& block) { return block.inner_close; }
};
struct OuterPairs {
  static constexpr auto name = "outer";
  static constexpr bool shifted = false;
  static auto& rows(auto& block) { return block.outer; }
  static auto& close(auto& block) { return block.outer_close; }
};
struct ImagePairs {
  static constexpr auto name = "image";
  static constexpr bool shifted = true;
  static auto& rows(auto& block) { return block.image; }
  static auto& close(auto& block) { return block.image_close; }
};
struct PlaneContacts {
  static constexpr auto name = "planes";
  static auto& rows(auto& block) { return block.planes; }
  static auto& springs(auto& block) { return block.plane_springs; }
};
struct Touches {
  static constexpr auto name = "touches";
  static auto& rows(auto& block) { return block.surfaces.touches; }
  static auto& springs(auto& block) { return block.surfaces.springs; }
};

template <class Visit>
void visit_kinds(const Visit& visit) {
  visit(InnerPairs{});
  visit(OuterPairs{});
  visit(ImagePairs{});
  visit(PlaneContacts{});
  visit(Touches{});
}

inline std::string state_name(const char* kind, const char* column) {
  return fmt::format("{}_{}", kind, column);
}

// ---- out ----------------------------------------------------------------------------------------

/// The rows of all blocks one after the other, column by column, and the numbers of the springs of
/// each contact. `several_laws`: the pairs tell which is theirs.
template <class Kind, class Real>
void store_kind(const std::vector<ContactBlock<Real>>& blocks, int spring_rows, bool several_laws,
                EngineState& state) {
  std::vector<double>& counts = state.add_scalars(state_name(Kind::name, "of_block"));
  for (const auto& block : blocks) {
    counts.push_back(static_cast<double>(Kind::rows(block).size()));
  }
  using Rows = std::remove_cvref_t<decltype(Kind::rows(blocks.front()))>;
  if constexpr (requires { Kind::shifted; }) {
    const Rows* const rows_type = nullptr;
    visit_columns(rows_type, {}, {Kind::shifted, several_laws},
                  [&](const char* column, auto member, double) {
                    std::vector<double>& values = state.add_scalars(state_name(Kind::name, column));
                    for (const auto& block : blocks) {
                      const auto& own = Kind::rows(block).*member;
                      values.insert(values.end(), own.begin(), own.end());
                    }
                  });
    std::vector<double>& springs = state.add_scalars(state_name(Kind::name, "springs"));
    for (const auto& block : blocks) {
      PairSprings<Real> taken;
      Kind::close(block).take_springs(taken);
      taken.store(spring_rows, springs);
    }
  } else {
    using Row = typename Rows::value_type;
    const Row* const row_type = nullptr;
    visit_columns(row_type, {}, [&](const char* column, auto member, double) {
      std::vector<double>& values = state.add_scalars(state_name(Kind::name, column));
      for (const auto& block : blocks) {
        for (const Row& row : Kind::rows(block)) values.push_back(static_cast<double>(row.*member));
      }
    });
    std::vector<double>& springs = state.add_scalars(state_name(Kind::name, "springs"));
    for (const auto& block : blocks) Kind::springs(block).store(springs);
  }
}

/// Which elements are near which particles, and where the particles touch.
template <class Real>
void store_surfaces(const std::vector<ContactBlock<Real>>& blocks, EngineState& state) {
  std::vector<double>& counts = state.add_scalars("near_of_block");
  std::vector<double>& mine = state.add_scalars("near_mine");
  std::vector<double>& material = state.add_scalars("near_material");
  std::vector<double>& elements_of = state.add_scalars("near_elements");
  std::vector<double>& elements = state.add_scalars("elements");
  std::vector<Vector3>& normal = state.add_vectors("touches_normal");
  std::vector<double>& distance = state.add_scalars("touches_distance");
  std::vector<Vector3>& velocity = state.add_vectors("touches_velocity");
  for (const ContactBlock<Real>& block : blocks) {
    const SurfaceContacts<Real>& contacts = block.surfaces;
    counts.push_back(static_cast<double>(contacts.near.size()));
    mine.insert(mine.end(), contacts.near.begin(), contacts.near.end());
    material.insert(material.end(), contacts.material.begin(), contacts.material.end());
    for (std::size_t k = 0; k < contacts.near.size(); ++k) {
      elements_of.push_back(contacts.first_element[k + 1] - contacts.first_element[k]);
    }
    elements.insert(elements.end(), contacts.elements.begin(), contacts.elements.end());
    for (const SurfaceTouch& touch : contacts.touches) {
      normal.emplace_back(touch.normal[0], touch.normal[1], touch.normal[2]);
      distance.push_back(touch.normal[3]);
      velocity.emplace_back(touch.velocity[0], touch.velocity[1], touch.velocity[2]);
    }
  }
  state.add_number("elements", static_cast<double>(elements.size()));
}

template <class Real>
Vector3 as_vector(const Real* row) {
  return {static_cast<double>(row[0]), static_cast<double>(row[1]), static_cast<double>(row[2])};
}

/// What the layout of the state hangs on: visit(name, own value, what it counts).
template <class Real, bool turning>
template <class Visit>
void SoftSpheres<Real, turning>::visit_scene(const Visit& visit) const {
  visit("real_bytes", double{sizeof(Real)}, "bytes of a number (particles.numerics.precision)");
  visit("spins", turning ? 1.0 : 0.0, "friction");
  visit("spring_rows", spring_rows(laws_.model()), "rows that a contact remembers");
  visit("materials", laws_.walls(), "number of materials");
  visit("surfaces", walls_.size(), "number of surfaces");
  visit("wall_elements", walls_.elements(), "number of triangles and planes of the walls");
  for (int side = 0; side < 6; ++side) {
    const std::string place = std::string("domain_") + side_name(side);
    visit(place.c_str(), domain_.plane(side), "place of a side [m]");
    const std::string kind = std::string("kind_") + side_name(side);
    visit(kind.c_str(), static_cast<double>(domain_.sides[side]), "kind of a side");
  }
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::store(EngineState& state) const {
  if (has_candidate_) {
    throw ProtocolError("the native engine cannot store its state: a candidate is pending");
  }
  state.add_number("native_state", native_state_version);
  visit_scene([&](const char* name, double own, const char*) { state.add_number(name, own); });
  store_rows(presented_, state);
  state.add_number("time", time_);
  state.add_number("walls_at", placed_at_);
  state.add_number("sub_steps", static_cast<double>(sub_steps_));
  state.add_number("rebuilds", static_cast<double>(rebuilds_));

  const List& list = lists_[list_];
  state.add_number("block_size", list.blocks.block_size);
  state.add_number("listed_time", list.time);
  state.add_number("listed_reach", list.reach);
  state.add_vectors("listed_origin").push_back(list.origin);
  state.add_scalars("row").assign(list.row.begin(), list.row.end());
  std::vector<Vector3>& listed_at = state.add_vectors("listed_at");
  std::vector<double>& listed_radius = state.add_scalars("listed_radius");
  for (const ListedAt& at : list.listed_at) {
    listed_at.push_back(as_vector(at.offset));
    listed_radius.push_back(static_cast<double>(at.offset[3]));
  }

  std::vector<Vector3>& position = state.add_vectors("body_position");
  std::vector<Vector3>& velocity = state.add_vectors("body_velocity");
  std::vector<Vector3>& force = state.add_vectors("contact_force");
  for (const int row : list.row) {
    position.push_back(presented_.position[row]);
    velocity.push_back(presented_.velocity[row]);
  }
  for (const Beyond& body : beyond_) position[body.place] = body.position;
  for (const LoadRow& load : loads_) force.push_back(as_vector(load.force));
  state.add_vectors("spin") = presented_.spin;
  if constexpr (turning) {
    std::vector<Vector3>& lever = state.add_vectors("contact_lever");
    for (const LoadRow& load : loads_) lever.push_back(as_vector(load.lever));
  }
  visit_kinds([&]<class Kind>(Kind) {
    store_kind<Kind>(list.block, spring_rows(laws_.model()), !law_table_.one_law, state);
  });
  store_surfaces(list.block, state);
}

// ---- in -----------------------------------------------------------------------------------------

/// Sizes of the parts of each block, which sum up to the rows of an array.
inline std::vector<std::size_t> read_parts(const StateReader& state, const std::string& name,
                                           std::size_t blocks, std::size_t& sum) {
  std::vector<std::size_t> parts = state.wholes<std::size_t>(name, blocks, 0x1p40);
  sum = std::accumulate(parts.begin(), parts.end(), std::size_t{0});
  return parts;
}

template <class Kind, class Real, class Limits>
void restore_kind(const StateReader& state, const ContactModel& model, bool several_laws,
                  const Limits& limits, std::vector<ContactBlock<Real>>& blocks) {
  std::size_t sum = 0;
  const auto parts = read_parts(state, state_name(Kind::name, "of_block"), blocks.size(), sum);
  const int rows_each = spring_rows(model);
  const auto each = 4 * static_cast<std::size_t>(rows_each);
  const auto springs = state.scalars(state_name(Kind::name, "springs"), sum * each);
  std::size_t first = 0;
  for (std::size_t b = 0; b < blocks.size(); first += parts[b++]) {
    auto& rows = Kind::rows(blocks[b]);
    using Rows = std::remove_reference_t<decltype(rows)>;
    const auto here = springs.subspan(first * each, parts[b] * each);
    const int count = static_cast<int>(parts[b]);
    const auto read_column = [&](const char* column, double end, const auto& put) {
      const std::string name = state_name(Kind::name, column);
      const auto values = state.scalars(name, sum);
      for (std::size_t k = 0; k < parts[b]; ++k) {
        put(k, StateReader::whole(name, first + k, values[first + k], end));
      }
    };
    if constexpr (requires { Kind::shifted; }) {
      const Rows* const rows_type = nullptr;
      visit_columns(rows_type, limits(b), {Kind::shifted, several_laws},
                    [&](const char* column, auto member, double end) {
                      auto& own = rows.*member;
                      using Whole = typename std::remove_reference_t<decltype(own)>::value_type;
                      own.resize(parts[b]);
                      read_column(column, end, [&](std::size_t k, double value) {
                        own[k] = static_cast<Whole>(value);
                      });
                    });
      PairSprings<Real> stored;
      std::vector<std::int32_t> room;
      stored.restore(count, spring_numbers(model), rows_each, here);
      Kind::close(blocks[b]).bring_back(rows, stored, room);
    } else {
      using Row = typename Rows::value_type;
      rows.assign(parts[b], Row{});
      const Row* const row_type = nullptr;
      visit_columns(row_type, limits(b), [&](const char* column, auto member, double end) {
        read_column(column, end, [&](std::size_t k, double value) {
          using Whole = std::remove_reference_t<decltype(rows[k].*member)>;
          rows[k].*member = static_cast<Whole>(value);
        });
      });
      Kind::springs(blocks[b]).restore(count, rows_each, here);
    }
  }
}

template <class Real, class Limits>
void restore_surfaces(const StateReader& state, int materials, int codes, const Limits& limits,
                      std::vector<ContactBlock<Real>>& blocks) {
  std::size_t sum = 0;
  const auto parts = read_parts(state, "near_of_block", blocks.size(), sum);
  const auto mine = state.scalars("near_mine", sum);
  const auto material = state.wholes<std::uint8_t>("near_material", sum, materials);
  std::size_t all = 0;
  const auto elements_of = read_parts(state, "near_elements", sum, all);
  state.require("elements", static_cast<double>(all), "number of triangles near particles");
  const auto elements = state.wholes<int>("elements", all, codes);
  std::size_t touches = 0;
  for (const ContactBlock<Real>& block : blocks) touches += block.surfaces.touches.size();
  const auto normal = state.vectors("touches_normal", touches);
  const auto distance = state.scalars("touches_distance", touches);
  const auto velocity = state.vectors("touches_velocity", touches);
  std::size_t near = 0;
  std::size_t element = 0;
  std::size_t touch = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    SurfaceContacts<Real>& contacts = blocks[b].surfaces;
    contacts.first_element.assign(1, 0);
    for (std::size_t k = 0; k < parts[b]; ++k, ++near) {
      contacts.near.push_back(static_cast<std::uint16_t>(
          StateReader::whole("near_mine", near, mine[near], limits(b).own)));
      contacts.material.push_back(material[near]);
      for (std::size_t n = 0; n < elements_of[near]; ++n) {
        contacts.elements.push_back(elements[element++]);
      }
      contacts.first_element.push_back(static_cast<int>(contacts.elements.size()));
    }
    for (SurfaceTouch& row : contacts.touches) {
      for (int axis = 0; axis < 3; ++axis) {
        row.normal[axis] = normal[touch][axis];
        row.velocity[axis] = velocity[touch][axis];
      }
      row.normal[3] = distance[touch++];
    }
  }
}

template <class Real, bool turning>
auto SoftSpheres<Real, turning>::restored_list(const StateReader& state, int count) const -> List {
  List list;
  const auto rows = static_cast<std::size_t>(count);
  list.blocks = blocks_of(count);
  state.require("block_size", list.blocks.block_size, "number of particles in a block");
  list.time = state.number("listed_time");
  list.reach = state.number("listed_reach");
  list.origin = state.vectors("listed_origin", 1).front();
  list.row = state.wholes<int>("row", rows, count);
  std::vector<bool> seen(rows, false);
  for (const int row : list.row) {
    if (seen[row]) throw ConfigError("the stored state's `row` has {} twice: it is damaged", row);
    seen[row] = true;
  }
  const auto listed_at = state.vectors("listed_at", rows);
  const auto listed_radius = state.scalars("listed_radius", rows);
  list.listed_at.resize(rows);
  list.block.resize(list.blocks.count());
  const auto limits = [&](std::size_t b) {
    const int block = static_cast<int>(b);
    return StateLimits{list.blocks.last(block) - list.blocks.first(block), count, laws_.count(),
                       walls_.size()};
  };
  visit_kinds([&]<class Kind>(Kind) {
    restore_kind<Kind>(state, laws_.model(), !law_table_.one_law, limits, list.block);
  });
  for (ContactBlock<Real>& block : list.block) find_partners(list.blocks, block);
  restore_surfaces(state, laws_.walls(), walls_.element_codes(), limits, list.block);
  for (std::size_t i = 0; i < rows; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      list.listed_at[i].offset[axis] = static_cast<float>(listed_at[i][axis]);
    }
    list.listed_at[i].offset[3] = static_cast<float>(listed_radius[i]);
  }
  return list;
}

template <class Real, bool turning>
void SoftSpheres<Real, turning>::restore(const Fields& fields) {
  const StateReader state(fields, "native_state", native_state_version);
  visit_scene(
      [&](const char* name, double own, const char* what) { state.require(name, own, what); });
  ParticleState stored = restored_rows(state, laws_.walls(), presented_, flow_);
  List list = restored_list(state, stored.size());
  const auto rows = static_cast<std::size_t>(stored.size());
  const auto position = state.vectors("body_position", rows);
  const auto velocity = state.vectors("body_velocity", rows);
  const auto force = state.vectors("contact_force", rows);
  const auto spin = state.vectors("spin", rows);
  const auto lever = turning ? state.vectors("contact_lever", rows) : std::span<const Vector3>{};
  const double time = state.number("time");
  const double walls_at = state.number("walls_at");
  const double sub_steps = state.number("sub_steps");
  const double rebuilds = state.number("rebuilds");

  stored.spin.assign(spin.begin(), spin.end());
  rollback();
  std::swap(presented_, stored);
  const Sizes own_sizes = sizes_;
  try {
    size_up();
  } catch (...) {
    presented_ = std::move(stored);
    sizes_ = own_sizes;
    throw;
  }
  swapped_ = false;
  bodies_.resize(rows);
  loads_.assign(rows, LoadRow{});
  for (std::size_t i = 0; i < rows; ++i) {
    BodyRow& body = bodies_[i] = body_of(list.row[i]);
    for (int axis = 0; axis < 3; ++axis) {
      body.position[axis] = position[i][axis];
      body.velocity[axis] = static_cast<Real>(velocity[i][axis]);
      loads_[i].force[axis] = static_cast<Real>(force[i][axis]);
      if constexpr (turning) {
        loads_[i].lever[axis] = static_cast<Real>(lever[i][axis]);
      }
    }
  }
  lists_[list_] = std::move(list);
  time_ = time;
  sub_steps_ = static_cast<std::int64_t>(sub_steps);
  rebuilds_ = static_cast<std::int64_t>(rebuilds);
  place_walls(walls_at);
  present();
}

}  // namespace fluxpact
