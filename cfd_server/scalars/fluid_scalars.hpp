// The scalars of a run: what scene.fluid.scalars asks for, advanced with the fluid's closed fluxes.
//
// Stands at the end of the fluid's window: when the fluxes are closed, each scalar moves with them.
// Committed and candidate fields, like those of the fluid. A scene without scalars has none of
// this.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cfd_server/scalars/scalar_step.hpp"
#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// One scalar at one time, and how it got there.
struct ScalarField {
  std::vector<double> value;          ///< c, one a cell
  std::vector<double> boundary_flux;  ///< what left through each boundary face in the window over
                                      ///< its length [kg/s], heat: [W]
  double source = 0;  ///< what appeared in the domain in the window over its length [kg/s], [W]
};

class FluidScalars {
 public:
  /// The stencil must outlive this. Throws ConfigError for a formula that is none.
  FluidScalars(const Scene& scene, const Mesh& mesh, const Stencil& stencil);
  ~FluidScalars();

  /// The fields of time 0. Throws NumericsError where a formula gives no finite number.
  void start();

  /// Candidate := committed, nothing has passed the boundary yet.
  void open_window();
  /// The candidate over one step that ends at `time` [s]. eddy_viscosity [Pa s], one a cell; empty:
  /// none. Throws NumericsError.
  void advance(const FluidStep& step, double time, std::span<const double> eddy_viscosity);
  /// After the last step of a window of this length [s]: the means over it.
  void close_window(double length);
  void commit();

  int count() const;
  const std::string& name(int index) const;
  const ScalarField& committed(int index) const;
  const ScalarField& candidate(int index) const;

 private:
  struct Scalar;
  const Stencil& stencil_;
  ScalarWork work_;
  std::vector<double> conductance_;    ///< [kg/s], one a face
  std::vector<double> source_;         ///< [kg c/s], one a cell; empty if no scalar has one
  std::vector<double> boundary_flux_;  ///< of a step [kg c/s], one a boundary face
  double schmidt_number_ = 0;          ///< turbulent [-]
  std::vector<Scalar> scalars_;
};

}  // namespace fluxpact
