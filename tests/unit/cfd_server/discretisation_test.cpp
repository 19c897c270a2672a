// The discrete operators against what they must do for linear and uniform fields, on any mesh.
#include <gtest/gtest.h>

#include <random>

#include "cfd_server/discretisation/gradient.hpp"
#include "cfd_server/discretisation/reconstruction.hpp"
#include "cfd_server/discretisation/transport.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"

namespace fluxpact {
namespace {

Mesh irregular_box() {
  FluidCase c({5, 4, 6}, {1, 0.8, 1.2});
  c.make_mesh();
  return perturbed(c.mesh, {0.2, 0.2, 0.2}, 0.15, 4);
}

struct LinearField {
  Vector3 constant{0.3, -1.0, 2.0};
  Matrix3 slope = (Matrix3() << 1.0, 2.0, -0.5, 0.7, -1.3, 0.2, 0.0, 0.4, 0.3).finished();
  Vector3 operator()(const Vector3& x) const { return constant + slope * x; }
};

std::vector<Vector3> at_centres(const Mesh& mesh, const LinearField& field) {
  std::vector<Vector3> values;
  for (const Vector3& x : mesh.cell_centres) values.push_back(field(x));
  return values;
}

std::vector<Vector3> boundary_jumps(const Mesh& mesh, const LinearField& field) {
  std::vector<Vector3> jumps;
  for (int f = mesh.internal_faces(); f < mesh.faces(); ++f) {
    jumps.emplace_back(field(mesh.face_centres[f]) - field(mesh.cell_centres[mesh.owner[f]]));
  }
  return jumps;
}

TEST(Gradient, is_exact_for_linear_fields_on_an_irregular_mesh) {
  const Mesh mesh = irregular_box();
  const Stencil stencil = make_stencil(mesh);
  const LinearField field;
  const std::vector<std::uint8_t> all(static_cast<std::size_t>(stencil.boundary_faces()), 1);
  std::vector<Matrix3> result(mesh.cell_volumes.size());
  gradient(stencil, gradient_coefficients(stencil, all), at_centres(mesh, field),
           boundary_jumps(mesh, field), result);
  for (const Matrix3& g : result)
    EXPECT_LE((g - field.slope).norm(), 1e-13);  // rounding of a few dozen terms
}

TEST(Gradient, is_zero_across_a_single_layer_of_cells) {
  FluidCase c({4, 1, 4}, {1, 0.1, 1});
  c.make_mesh();
  const Stencil stencil = make_stencil(c.mesh);
  const std::vector<std::uint8_t> none(static_cast<std::size_t>(stencil.boundary_faces()), 0);
  std::vector<double> field;
  field.reserve(c.mesh.cell_centres.size());
  for (const Vector3& x : c.mesh.cell_centres) field.push_back(3 * x.x() - x.z());
  const std::vector<double> jumps(none.size(), 0.0);
  std::vector<Vector3> result(field.size());
  gradient(stencil, gradient_coefficients(stencil, none), field, jumps, result);
  for (const Vector3& g : result) EXPECT_LE((g - Vector3(3, 0, -1)).norm(), 1e-13);
}

TEST(Reconstruction, is_exact_for_linear_fields_on_an_irregular_mesh) {
  const Mesh mesh = irregular_box();
  const Stencil stencil = make_stencil(mesh);
  const LinearField field;
  std::vector<double> flux;
  flux.reserve(mesh.owner.size());
  for (int f = 0; f < mesh.faces(); ++f)
    flux.push_back(field(mesh.face_centres[f]).dot(mesh.face_areas[f]));
  const std::vector<Matrix3> gradients(mesh.cell_volumes.size(), field.slope);
  std::vector<Vector3> result(mesh.cell_volumes.size());
  reconstruct(stencil, reconstruction_coefficients(stencil), flux, gradients, result);
  const std::vector<Vector3> expected = at_centres(mesh, field);
  for (std::size_t cell = 0; cell < result.size(); ++cell) {
    EXPECT_LE((result[cell] - expected[cell]).norm(), 1e-13);
  }
}

TransportCoefficients random_fluxes(const Stencil& stencil) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> flux(-1, 1);
  const auto faces = static_cast<std::size_t>(stencil.faces);
  TransportCoefficients c{std::vector<double>(faces), std::vector<double>(faces),
                          std::vector<double>(faces), std::vector<double>(faces)};
  for (int f = 0; f < stencil.faces; ++f) {
    c.mass_flux[f] = flux(random);
    c.diffusion[f] = std::abs(flux(random));
  }
  finish_coefficients(c);
  return c;
}

TEST(Transport, leaves_a_uniform_field_alone_whatever_the_fluxes) {
  const Mesh mesh = irregular_box();
  const Stencil stencil = make_stencil(mesh);
  const TransportCoefficients coefficients = random_fluxes(stencil);
  const std::vector<Vector3> uniform(mesh.cell_volumes.size(), Vector3(1.7, -0.3, 0.9));
  const std::vector<Vector3> jumps(static_cast<std::size_t>(stencil.boundary_faces()),
                                   Vector3::Zero());
  const std::vector<std::uint8_t> all(jumps.size(), 1);
  std::vector<Matrix3> gradients(uniform.size());
  gradient(stencil, gradient_coefficients(stencil, all), uniform, jumps, gradients);
  std::vector<Vector3> force(uniform.size(), Vector3::Ones());
  for (const Convection scheme :
       {Convection::upwind, Convection::linear_upwind, Convection::limited}) {
    transport_force(stencil, coefficients, scheme, uniform, jumps, gradients, force);
    for (const Vector3& f : force) EXPECT_EQ(f, Vector3(Vector3::Zero()));
  }
}

TEST(Transport, linear_upwind_and_diffusion_are_exact_for_linear_fields_inside) {
  const Mesh mesh = irregular_box();
  const Stencil stencil = make_stencil(mesh);
  const LinearField field;
  const std::vector<Vector3> velocity = at_centres(mesh, field);
  const std::vector<Vector3> jumps = boundary_jumps(mesh, field);
  const std::vector<Matrix3> gradients(velocity.size(), field.slope);
  TransportCoefficients c = random_fluxes(stencil);
  for (int f = 0; f < stencil.faces; ++f) c.diffusion[f] = 0.3 * stencil.conductance[f];
  finish_coefficients(c);
  std::vector<Vector3> force(velocity.size());
  transport_force(stencil, c, Convection::linear_upwind, velocity, jumps, gradients, force);
  // Σ [ −F (u(x_f) − u_P) + 0.3 ∇u A ]: the last term cancels over a closed cell. Upwind values at
  // the boundary are the cell's own where it flows out, so only cells without a boundary face are
  // compared.
  for (int cell = 0; cell < stencil.cells; ++cell) {
    Vector3 expected = Vector3::Zero();
    bool inside = true;
    for (int side = stencil.side_offsets[cell]; side < stencil.side_offsets[cell + 1]; ++side) {
      const int f = stencil.side_face[side];
      inside = inside && f < stencil.internal_faces;
      expected -=
          stencil.side_sign[side] * c.mass_flux[f] * (field(mesh.face_centres[f]) - velocity[cell]);
    }
    if (!inside) continue;
    EXPECT_LE((force[cell] - expected).norm(), 1e-12) << "cell " << cell;
  }
}

TEST(Transport, limited_convection_makes_no_new_extremum) {
  // A step carried along a row by F = 1: the higher-order face value stays between its two cells.
  FluidCase c({20, 1, 1}, {1, 0.1, 0.1});
  c.make_mesh();
  const Stencil stencil = make_stencil(c.mesh);
  std::vector<double> profile{0,   0,   0,   0,    0.2, 0.9, 1, 1, 1, 0.7,
                              0.3, 0.3, 0.3, 0.31, 0.5, 0.4, 0, 0, 0, 0};
  std::vector<Vector3> velocity;
  velocity.reserve(profile.size());
  for (const double v : profile) velocity.emplace_back(v, -v, 2 * v);
  const std::vector<Vector3> jumps(static_cast<std::size_t>(stencil.boundary_faces()),
                                   Vector3::Zero());
  const std::vector<std::uint8_t> none(jumps.size(), 0);
  std::vector<Matrix3> gradients(velocity.size());
  gradient(stencil, gradient_coefficients(stencil, none), velocity, jumps, gradients);
  TransportCoefficients t = random_fluxes(stencil);
  for (int f = 0; f < stencil.faces; ++f) {
    t.mass_flux[f] = f < stencil.internal_faces ? 1.0 : 0.0;
    t.diffusion[f] = 0;
  }
  finish_coefficients(t);
  std::vector<Vector3> force(velocity.size());
  transport_force(stencil, t, Convection::limited, velocity, jumps, gradients, force);
  // One explicit step at Courant number 1/2 must keep 0 <= u <= 1 (total variation diminishing, ψ
  // <= 2).
  bool sharper_than_upwind = false;
  for (std::size_t cell = 1; cell < 19; ++cell) {
    const double next = profile[cell] + 0.5 * force[cell].x();
    EXPECT_GE(next, -1e-15) << "cell " << cell;
    EXPECT_LE(next, 1 + 1e-15) << "cell " << cell;
    sharper_than_upwind = sharper_than_upwind ||
                          std::abs(force[cell].x() - (profile[cell - 1] - profile[cell])) > 0.05;
  }
  EXPECT_TRUE(sharper_than_upwind);
}

}  // namespace
}  // namespace fluxpact
