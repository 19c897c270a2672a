// From the contact laws of a scene to materials of YADE, which gives springs and dashpots to bodies
// and puts those of two that touch in series.
#pragma once

#include <vector>

#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

/// The free particles of a scene for YADE: all alike, since one material has one dashpot whatever
/// the mass it acts on.
struct YadeSpheres {
  double radius = 0;   ///< [m]
  double density = 0;  ///< [kg/m³]
  int material = 0;    ///< index into the scene's materials
};

/// A column for each number of Law2_ScGeom_ViscElPhys_Basic, a row for each kind of body: the free
/// particles, then one for the fixed particles of each material of the scene, then the walls.
struct YadeMaterials {
  std::vector<double> kn;              ///< [N/m]; of the body, 0: rigid
  std::vector<double> ks;              ///< [N/m]; of the body, 0: rigid
  std::vector<double> cn;              ///< [kg/s]
  std::vector<double> cs;              ///< [kg/s]
  std::vector<double> friction_angle;  ///< [rad] of each two kinds
};

/// What a body must have so that in series with `partner` it gives `wanted`: 1/wanted - 1/partner,
/// inverted. That is negative for a contact stiffer than the partner alone would be, which YADE
/// takes: only the series counts. A partner of 0 is left out of the series by YADE, and so is the
/// answer 0, for `wanted` = `partner`. Nothing in series gives 0: a billionth of the partner
/// stands for it.
double in_series_with(double partner, double wanted);

/// Materials with which every contact of a free sphere has exactly the stiffness, the dashpot and
/// the friction of the linear law: of two spheres, m* = m/2; of one and a fixed one or a wall,
/// m* = m. Kinds that the scene gives no pair for get those of the free particles.
YadeMaterials yade_materials(const ContactLaws& laws, const YadeSpheres& spheres);

/// Row of YadeMaterials.
int yade_kind(const ParticleState& particles, int row);

}  // namespace fluxpact
