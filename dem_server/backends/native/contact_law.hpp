// The parameters of a contact for each pair of materials: from what a scene gives (stiffness or
// elasticity, restitution, ...) to the plain numbers that the force of a contact reads. Set up once
// when the engine is made; the force itself is in contact_force-inl.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/scene/scene.hpp"

namespace fluxpact {

/// The laws that all contacts of a scene follow; what differs from pair to pair is numbers only.
struct ContactModel {
  ContactLaw law = ContactLaw::linear;
  RollingLaw rolling = RollingLaw::none;
  CohesionLaw cohesion = CohesionLaw::none;
  bool film = false;      ///< the fluid between surfaces that come close resists (lubrication)
  bool friction = false;  ///< some pair has friction or the scene a rolling law: spins are followed
};

/// Rows of four numbers that a contact keeps between two steps, zero when the surfaces meet anew:
/// first the tangential spring [m] and whether a bridge or an adhesive contact holds (with
/// friction, liquid_bridge or jkr), then the rolling spring [rad] and 0 (spring_dashpot).
int spring_rows(const ContactModel& model);

/// The numbers of those rows that the laws of a model use, in the order in which pairs keep them.
struct SpringNumbers {
  int count = 0;
  std::array<std::uint8_t, 7> place{};  ///< of each: four times the row, and its place in the row

  /// True for those that look the same from both partners; the others change their sign.
  bool is_even(int n) const { return place[n] % 4 == 3; }
};
SpringNumbers spring_numbers(const ContactModel& model);

/// True if a contact may hold beyond δ = 0, so that it must remember whether it does.
inline bool outlasts_touch(CohesionLaw cohesion) {
  return cohesion == CohesionLaw::liquid_bridge || cohesion == CohesionLaw::jkr;
}

/// What the force of a contact reads, one number a column; m* = m_i m_j/(m_i + m_j) and
/// R* = r_i r_j/(r_i + r_j) belong to the two particles.
enum class LawColumn {
  normal,               ///< linear: k_n [N/m]; hertz: 2 E* [Pa]
  tangential,           ///< linear: k_t [N/m]; hertz: 8 G* [Pa]
  tangential_softness,  ///< linear: 1/k_t [m/N]
  damping,  ///< c_n = damping sqrt(S m*), S = 1 (linear, [sqrt(N/m)]) or 2 E* a (hertz, [-])
  tangential_damping,  ///< c_t / c_n [-]
  friction,            ///< [-]
  rolling_friction,    ///< largest torque over force and R* [-]
  rolling_stiffness,   ///< of the rolling spring over normal stiffness and R*² [-]
  rolling_damping,     ///< share of critical damping [-]
  attraction,  ///< sjkr: 2 π times the energy density [J/m³]; liquid_bridge: 4 π γ cos θ [N/m];
               ///< jkr: (π w / 8 E*)^(1/3) [m^(1/3)]
  bridge_shape,    ///< liquid_bridge: 2 / V [1/m³]
  bridge_rupture,  ///< liquid_bridge: distance of the surfaces at which it breaks [m]; 0: dry
  film_viscosity,  ///< lubrication: 6 π μ [Pa s]
  film_thinnest,   ///< lubrication: roughness [m]
  film_closeness,  ///< lubrication: 1/reach [1/m]
};
inline constexpr int law_columns = static_cast<int>(LawColumn::film_closeness) + 1;

/// The fluid between surfaces that come close (lubrication).
struct Film {
  double viscosity = 0;  ///< μ [Pa s]
  double roughness = 0;  ///< [m]
  double reach = 0;      ///< [m]
};

/// One pair of materials.
struct PairLaw {
  double column[law_columns] = {};
  bool given = false;

  double operator[](LawColumn name) const { return column[static_cast<std::size_t>(name)]; }
  double& operator[](LawColumn name) { return column[static_cast<std::size_t>(name)]; }
};

/// |ln e| / sqrt(π² + ln² e): the share of critical damping with which a contact rebounds at e
/// times the speed of approach (separation at zero overlap, attraction at its end kept). Exact for
/// the linear law, and for Hertz' with a dashpot in proportion to sqrt(S_n) (Antypov & Elliott,
/// Europhys. Lett. 94, 2011, 50004). 1 for e = 0.
double damping_ratio(double restitution);

/// Coefficient [kg/s] of the normal dashpot of the linear law: 2 ζ sqrt(k m*), which is γ_n m* of
/// other codes.
double damping_coefficient(const PairLaw& law, double effective_mass);

/// Laws by two materials, or a material and the walls.
class ContactLaws {
 public:
  /// Throws ConfigError for a pair that names an unknown material, stands twice, has a value
  /// outside its range, or lacks one that the laws of the scene need.
  explicit ContactLaws(const ParticleSettings& settings, const std::optional<Film>& film = {});

  const ContactModel& model() const { return model_; }
  int walls() const { return static_cast<int>(names_.size()) - 1; }  ///< the walls' material index
  int index(int a, int b) const { return a * static_cast<int>(names_.size()) + b; }
  int count() const { return static_cast<int>(laws_.size()); }  ///< of pairs, in both orders
  const PairLaw& operator[](int index) const { return laws_[index]; }
  const std::string& name(int material) const { return names_[material]; }
  /// Rayleigh's time [s] of a sphere of this material over r sqrt(ρ) [m sqrt(kg/m³)], hertz only
  /// (step_limit.hpp).
  double rayleigh_factor(int material) const { return rayleigh_factors_[material]; }
  bool any_friction() const { return model_.friction; }

 private:
  int find(const std::string& name) const;
  ContactModel model_;
  std::vector<std::string> names_;  // the materials in the order of the scene's map, then the walls
  std::vector<PairLaw> laws_;
  std::vector<double> rayleigh_factors_;
};

/// How far [m] beyond touching surfaces a contact acts: what a list of neighbours adds to its
/// cutoff, for particles up to `largest_radius` [m]. 0 without liquid bridges, jkr and films.
double reach_beyond_contact(const ContactLaws& laws, double largest_radius);

/// All pairs as one table of plain numbers, T = float or double: column by column, in a column the
/// pairs by ContactLaws::index. Pairs without an entry are zero.
template <class T>
struct LawTable {
  ContactModel model;
  int pairs = 0;
  bool one_law =
      false;    ///< all given pairs are equal, walls included: any index with `given` will do
  int any = 0;  ///< the index of a given pair
  std::vector<T> values;

  const T* column(LawColumn name) const {
    return values.data() + static_cast<std::size_t>(name) * static_cast<std::size_t>(pairs);
  }
};

template <class T>
LawTable<T> law_table(const ContactLaws& laws);
extern template LawTable<double> law_table(const ContactLaws&);
extern template LawTable<float> law_table(const ContactLaws&);

/// Mass of a sphere [kg] from its radius [m] and density [kg/m³].
double sphere_mass(double radius, double density);

}  // namespace fluxpact
