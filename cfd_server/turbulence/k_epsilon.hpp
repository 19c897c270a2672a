// The standard k-epsilon model: two transported fields, and the eddy viscosity that they make.
//
//     ∂(ε_v ρ k)/∂t + ∇·(Φ k) = ∇·(ε_v (μ + μ_t/σ_k) ∇k) + ε_v (G − ρ ε)
//     ∂(ε_v ρ ε)/∂t + ∇·(Φ ε) = ∇·(ε_v (μ + μ_t/σ_ε) ∇ε) + ε_v (C_1 G − C_2 ρ ε) ε/k
// μ_t = ρ C_μ k²/ε, G = μ_t |S|², ε_v the voidage (B.E. Launder, D.B. Spalding, Comput. Methods
// Appl. Mech. Eng. 3, 1974, 269-289). What the particles add to or take from k is left out.
// Implicit upwind with the sinks linearised as −(sink/k) k^{n+1} (S.V. Patankar, Numerical Heat
// Transfer and Fluid Flow, 1980, section 7.2): every coefficient has the sign that keeps k and ε
// positive, and so has each sweep of the solver.
#pragma once

#include <cstdint>
#include <vector>

#include "cfd_server/scalars/scalar_step.hpp"
#include "cfd_server/turbulence/wall_function.hpp"
#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// One time level. One entry a cell.
struct TurbulentLevel {
  std::vector<double> energy;       ///< k [m²/s²]
  std::vector<double> dissipation;  ///< ε [m²/s³]
};

/// A boundary face with a wall function.
struct WallFace {
  int face = 0;  ///< boundary face, counted from the first one
  int cell = 0;
  double distance = 0;  ///< [m] of the cell's centre
  double share = 1;     ///< one over the wall faces of its cell
};

/// What the flow does to k and ε in a step.
struct TurbulentFlow {
  double density = 0;                  ///< [kg/m³]
  double viscosity = 0;                ///< molecular [Pa s]
  std::span<const double> strain;      ///< |S| [1/s], one a cell
  std::span<const double> wall_speed;  ///< tangential, relative to the wall [m/s]; one a wall face
  std::span<const Vector3> inlet_velocity;  ///< interstitial [m/s], one a boundary face
};

class KEpsilon {
 public:
  /// The stencil must outlive this. Throws ConfigError if a patch of inlets is not in the mesh.
  KEpsilon(const Scene& scene, const Mesh& mesh, const Stencil& stencil);

  /// μ_t [Pa s] of a level, one a cell, and μ at each wall face [Pa s] for the momentum equation.
  void find_viscosity(const TurbulentLevel& level, double density, std::span<double> eddy) const;
  double wall_viscosity(const TurbulentLevel& level, const WallFace& wall, double density,
                        double viscosity) const;

  /// `level` over one step. eddy: μ_t of its start. Throws NumericsError if the solver fails.
  void advance(const FluidStep& step, const TurbulentFlow& flow, std::span<const double> eddy,
               TurbulentLevel& level);

  const std::vector<WallFace>& walls() const { return walls_; }
  TurbulentLevel start() const;

 private:
  void set_inlets(std::span<const Vector3> velocity);
  void set_production(const TurbulentFlow& flow, std::span<const double> eddy,
                      const TurbulentLevel& level);
  void solve(const FluidStep& step, const ScalarBoundary& boundary, const char* name,
             std::span<double> value);

  struct Inlet {
    int face = 0;  ///< boundary face
    double intensity = 0;
    double length_scale = 0;  ///< [m]
  };

  const Stencil& stencil_;
  KEpsilonConstants constants_;
  double layer_ = 0;
  double start_energy_ = 0;
  double start_dissipation_ = 0;
  std::vector<WallFace> walls_;
  std::vector<Inlet> inlets_;
  ScalarBoundary energy_boundary_, dissipation_boundary_;
  ScalarWork work_;
  std::vector<double> production_;    ///< G [W/m³], one a cell
  std::vector<double> at_wall_;       ///< ε that wall functions give [m²/s³], one a cell
  std::vector<std::uint8_t> walled_;  ///< 1 where they do
  std::vector<double> conductance_;   ///< [kg/s], one a face
  std::vector<double> source_, sink_;
};

}  // namespace fluxpact
